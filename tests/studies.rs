//! Studies: points of sweeps and tables in slices. The collected table has the same bytes for all slicings, kills and
//! numbers of threads; nothing is lost, and no file is half-written.

use crate::support::Temporary;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use eng::results::{Column, Results};
use eng::{Dimension, DisplayUnit};

const MODEL: &str = "use std.joints.Revolute

model Swing {
    param length: Length = 400 mm in (10 mm, 2 m)
    param load: Mass = 1.2 kg
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = load; inertia = [2, 2, 2] g*m^2; marker top = [0, 1, 0]*length }
    joint pin = Revolute(bob.top, pivot)
    param tilt: Angle = 30 deg
    start pin.angle = tilt
    output height = dot(bob.origin.origin, ground.y) as mm
}

analysis swing = transient(Swing(), duration: DURATION, sample: 10 ms)
analysis lengths[l in 100 mm .. 1200 mm by 100 mm] = transient(Swing(length: l), duration: DURATION, sample: 10 ms)
analysis small[l in 100 mm .. 300 mm by 100 mm] = linear(Swing(length: l, tilt: 0 deg), up_to: 100 Hz)

report size \"Size\" {
    value highest = maximum(swing.height) as mm
    value both = [maximum(swing.height), minimum(swing.height)] as mm
    require maximum(swing.height) < -200 mm else \"it is high\"
}
";

/// Twelve points, of which the fourth is outside of the limits.
const DESIGN: &str = "length [mm],load [kg]
100,1\n200,1\n300,2\n3000,2\n500,1\n600,1.5\n700,1\n800,0.7\n900,1\n1000,1e0\n1100,1\n1200,1\n";

struct Place(Temporary);

impl Place {
    fn new(name: &str, duration: &str) -> Place {
        let folder = Temporary::new(&format!("studies-{name}"));
        let model = MODEL.replace("DURATION", duration);
        std::fs::write(folder.join("swing.eng"), model).unwrap();
        std::fs::write(folder.join("design.csv"), DESIGN).unwrap();
        Place(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_eng"));
        command
            .current_dir(&self.0)
            .args(words.split_whitespace())
            .env("ENG_CACHE", self.path("cache"))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    fn eng(&self, words: &str) -> Output {
        self.command(words).output().unwrap()
    }

    /// The output of a command that ends with an exit code.
    fn says(&self, words: &str, code: i32) -> String {
        let output = self.eng(words);
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8(said).unwrap();
        assert_eq!(output.status.code(), Some(code), "{words}: {said}");
        said
    }

    fn files(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(folder)).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    fn collected(&self, out: &str, analysis: &str, code: i32) -> Vec<u8> {
        self.says(&format!("collect {out} --analysis {analysis}"), code);
        std::fs::read(self.path(out).join(format!("{analysis}.points.parquet"))).unwrap()
    }
}

/// Waits until a file has some lines, while a process runs.
fn wait_for_lines(path: &Path, lines: usize, child: &mut Child) {
    let began = Instant::now();
    loop {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        if text.lines().count() >= lines {
            return;
        }
        assert!(
            child.try_wait().unwrap().is_none(),
            "it ended before it was killed"
        );
        assert!(
            began.elapsed() < Duration::from_secs(60),
            "{} never came",
            path.display()
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

const RUN: &str = "run swing.eng --analysis swing --design design.csv --quiet";

#[test]
fn slices_threads_and_kills_give_the_same_bytes() {
    let place = Place::new("same", "4 s");
    place.says(&format!("{RUN} --slice 1/1 --out one --threads 1"), 1);
    let one = place.collected("one", "swing", 1);
    for slice in [2, 3, 1] {
        let code = i32::from(slice == 1);
        place.says(
            &format!("{RUN} --slice {slice}/3 --out three --threads 3"),
            code,
        );
    }
    assert!(one == place.collected("three", "swing", 1));
    // killed twice: once after some points, once with the next line half-written
    let words = format!("{RUN} --slice 1/1 --out killed --threads 1");
    let begun = place.path("killed/swing/part-00001-00012.points");
    for lines in [4, 9] {
        let mut child = place.command(&words).spawn().unwrap();
        wait_for_lines(&begun, lines, &mut child);
        let status = place.says("status killed", 0);
        assert!(status.contains("part 1..12 runs at"), "{status}");
        child.kill().unwrap();
        child.wait().unwrap();
        let text = std::fs::read(&begun).unwrap();
        std::fs::write(&begun, &text[..text.len() - 7]).unwrap();
    }
    let status = place.says("status killed", 0);
    assert!(status.contains("part 1..12 was killed at"), "{status}");
    assert!(status.contains("missing: "), "{status}");
    place.says(&words, 1);
    assert!(one == place.collected("killed", "swing", 1));
    assert_eq!(
        place.files("killed/swing"),
        ["part-00001-00012.parquet", "study.json"]
    );
    // a part is the same file, however it came about
    let part =
        |out: &str| std::fs::read(place.path(out).join("swing/part-00001-00012.parquet")).unwrap();
    assert!(part("one") == part("killed"));
    // other slices of the same points take what is there
    let said = place.says(
        "run swing.eng --analysis swing --design design.csv --slice 1/1 --out three",
        1,
    );
    assert!(said.contains("were there, and are not run again"), "{said}");
}

#[test]
fn points_of_a_sweep_are_those_of_single_runs() {
    let place = Place::new("sweep", "100 ms");
    for points in ["1..5", "6..11", "12"] {
        place.says(
            &format!("run swing.eng --analysis lengths --quiet --points {points} --out parts"),
            0,
        );
    }
    place.collected("parts", "lengths", 0);
    place.says(
        "run swing.eng --analysis lengths --quiet --no-plots --out single",
        0,
    );
    let single = Results::read(place.path("single/lengths.parquet")).unwrap();
    // the numbers of `eng run` over the whole sweep, bit for bit
    let points = Results::read(place.path("parts/lengths.points.parquet"));
    assert!(
        points
            .unwrap_err()
            .to_string()
            .contains("it holds the points of a study")
    );
    let parts = numbers(&place.path("parts/lengths.points.parquet"));
    for column in single.columns() {
        let own = parts.iter().find(|(name, _)| *name == column.path);
        let own = &own.unwrap_or_else(|| panic!("no {}", column.path)).1;
        let shown: Vec<u64> = column.shown().iter().map(|value| value.to_bits()).collect();
        let own: Vec<u64> = own.iter().map(|value| value.to_bits()).collect();
        assert_eq!(own, shown, "{}", column.path);
    }
    // modes: several rows a point
    place.says(
        "run swing.eng --analysis small --quiet --slice 1/1 --out parts",
        0,
    );
    place.collected("parts", "small", 0);
    let modes = numbers(&place.path("parts/small.points.parquet"));
    let frequency = &modes
        .iter()
        .find(|(name, _)| name == "frequency")
        .unwrap()
        .1;
    assert_eq!(frequency.len(), 3);
    // ω² = g l/(l² + J/m)
    for (length, frequency) in [0.1, 0.2, 0.3].iter().zip(frequency) {
        let rate: f64 = 9.81 * length / (length * length + 2e-3 / 1.2);
        let expected = rate.sqrt() / std::f64::consts::TAU;
        assert!(
            (frequency - expected).abs() < 1e-6 * expected,
            "{frequency} {expected}"
        );
    }
}

/// A column of texts of a collected table.
fn texts(path: &Path, name: &str) -> Vec<Option<String>> {
    use arrow_array::StringArray;
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
    let file = std::fs::File::open(path).unwrap();
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
    let mut found = Vec::new();
    for batch in reader.build().unwrap() {
        let batch = batch.unwrap();
        let column = batch.column_by_name(name).unwrap().as_any();
        let texts = column.downcast_ref::<StringArray>().unwrap().iter();
        found.extend(texts.map(|text| text.map(str::to_owned)));
    }
    found
}

/// The columns of floats of a collected table.
fn numbers(path: &Path) -> Vec<(String, Vec<f64>)> {
    use arrow_array::{Array, Float64Array};
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
    let file = std::fs::File::open(path).unwrap();
    let reader = ParquetRecordBatchReaderBuilder::try_new(file)
        .unwrap()
        .build()
        .unwrap();
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    for batch in reader {
        let batch = batch.unwrap();
        for (field, array) in batch.schema().fields().iter().zip(batch.columns()) {
            let Some(array) = array.as_any().downcast_ref::<Float64Array>() else {
                continue;
            };
            let values = (0..array.len()).map(|row| match array.is_null(row) {
                true => f64::NAN,
                false => array.value(row),
            });
            match columns.iter_mut().find(|(name, _)| name == field.name()) {
                Some((_, known)) => known.extend(values),
                None => columns.push((field.name().clone(), values.collect())),
            }
        }
    }
    columns
}

#[test]
fn failures_are_rows_and_can_be_run_again() {
    let place = Place::new("failures", "50 ms");
    let said = place.says(
        "run swing.eng --analysis swing --design design.csv --slice 1/2 --out out",
        1,
    );
    assert!(
        said.contains("1 point failed with E0722: 4; the first: length = 3000 mm is outside"),
        "{said}"
    );
    place.says(&format!("{RUN} --slice 2/2 --out out"), 0);
    place.collected("out", "swing", 1);
    let table = numbers(&place.path("out/swing.points.parquet"));
    let column = |name: &str| &table.iter().find(|(known, _)| known == name).unwrap().1;
    assert_eq!(column("length")[3], 3000.0);
    assert!(column("report.size.highest")[3].is_nan() && column("height.largest")[3].is_nan());
    let bits = |name: &str| -> Vec<u64> { column(name).iter().map(|x| x.to_bits()).collect() };
    assert_eq!(bits("report.size.highest"), bits("report.size.both[1]"));
    let holds = column("report.size.holds");
    assert_eq!(
        (holds[0], holds[1], holds[2], holds[11]),
        (0.0, 0.0, 1.0, 1.0)
    );
    let messages = texts(&place.path("out/swing.points.parquet"), "message");
    assert_eq!(messages[0].as_deref(), Some("it is high"));
    assert!(
        messages[3]
            .as_deref()
            .unwrap()
            .contains("is outside its limits")
    );
    assert_eq!(messages[11], None);
    // the part with the failure is computed again, the other one stays
    let part = place.path("out/swing/part-00007-00012.parquet");
    let written = std::fs::metadata(&part).unwrap().modified().unwrap();
    let said = place.says(
        "run swing.eng --analysis swing --design design.csv --points failed --out out",
        1,
    );
    assert!(
        said.contains("points 1..6 are there, 1 of them run now"),
        "{said}"
    );
    assert_eq!(
        std::fs::metadata(&part).unwrap().modified().unwrap(),
        written
    );
}

#[test]
fn wrong_designs_are_refused_before_any_run() {
    let place = Place::new("designs", "50 ms");
    for (design, message) in [
        (
            "width [mm]\n1\n",
            "the column width: there is no parameter width",
        ),
        ("lenght [mm]\n1\n", "did you mean length?"),
        (
            "length\n1\n",
            "it states no unit; write the unit into its name: length [mm]",
        ),
        (
            "length [kg]\n1\n",
            "kg does not fit; write a unit such as length [mm]",
        ),
        ("length [furlong]\n1\n", "there is no unit furlong"),
        ("length [mm]\n", "there are no points"),
        ("", "the file is empty"),
        (
            ",length [mm]\n0,1\n",
            "pandas writes such a column for its index",
        ),
        (
            "length [mm]\n1 mm\n",
            "line 2: \"1 mm\" in the column length is no number",
        ),
        (
            "length [mm]\nnan\n",
            "length of point 1 is not a finite number",
        ),
        (
            "length [mm],length [m]\n1,1\n",
            "there are two columns of length",
        ),
        ("length [mm],load [kg]\n1\n", "line 2 has 1 cell, and"),
    ] {
        std::fs::write(place.path("wrong.csv"), design).unwrap();
        let said = place.says(
            "run swing.eng --analysis swing --design wrong.csv --out out",
            2,
        );
        assert!(said.contains(message), "{said}");
        assert!(said.contains("wrong.csv"), "{said}");
    }
    std::fs::write(place.path("wrong.parquet"), "length [mm]\n1\n").unwrap();
    for (words, message) in [
        ("--analysis swing --design none.csv", "none.csv: "),
        (
            "--analysis swing --design wrong.parquet",
            "wrong.parquet: the Parquet file is damaged",
        ),
        (
            "--analysis swing --slice 1/2",
            "swing is one analysis without points",
        ),
        (
            "--analysis lengths --design design.csv",
            "lengths has points of its own",
        ),
        (
            "--analysis lengths --points 5..13",
            "lengths has the points 1..12",
        ),
        ("--analysis lengths --slice 1/13", "fewer than 13 slices"),
        (
            "--analysis lengths --slice 0/3",
            "give the number of the slice",
        ),
        (
            "--analysis lengths --points 3..2",
            "give the first and the last point",
        ),
        ("--analysis none --slice 1/2", "there is no analysis none"),
        (
            "--slice 1/2",
            "points belong to one analysis; name one of swing, lengths, small",
        ),
        (
            "--analysis swing --design design.csv --set length=1m",
            "--set gives it one value for all points",
        ),
        (
            "--analysis swing --design design.csv --csv",
            "cannot be used with",
        ),
    ] {
        let said = place.says(&format!("run swing.eng {words} --out out"), 2);
        assert!(said.contains(message), "{said}");
    }
    assert!(!place.path("out").exists());
    let text = std::fs::read_to_string(place.path("swing.eng")).unwrap();
    let named = text
        .replace("output height", "output state")
        .replace("swing.height", "swing.state");
    std::fs::write(place.path("named.eng"), named).unwrap();
    place.says(
        "run named.eng --analysis swing --design design.csv --points 1 --out named",
        0,
    );
    let named = text.replace("load", "code");
    std::fs::write(place.path("named.eng"), named).unwrap();
    std::fs::write(place.path("named.csv"), "code [kg]\n1\n").unwrap();
    let said = place.says(
        "run named.eng --analysis swing --design named.csv --out other",
        2,
    );
    assert!(said.contains("a column `code` of its own"), "{said}");
}

#[test]
fn a_parquet_file_is_a_design() {
    let place = Place::new("parquet", "50 ms");
    let mut design = Results::new("design", "any");
    for (path, symbol, scale, dimension, values) in [
        ("length", "mm", 1e-3, Dimension::LENGTH, [0.1, 0.25]),
        ("load", "kg", 1.0, Dimension::MASS, [1.0, 2.0]),
    ] {
        design
            .push(Column {
                path: path.to_owned(),
                dimension,
                display: DisplayUnit {
                    symbol: symbol.to_owned(),
                    scale,
                    offset: 0.0,
                },
                frame: String::new(),
                values: values.to_vec(),
            })
            .unwrap();
    }
    let path = design.write_parquet(&place.0).unwrap();
    assert_eq!(path, place.path("design.parquet"));
    std::fs::write(
        place.path("same.csv"),
        "length[mm];load [kg];\n100;1;\n250;2,0\n",
    )
    .unwrap();
    for (file, out) in [("design.parquet", "a"), ("same.csv", "b")] {
        place.says(
            &format!("run swing.eng --analysis swing --design {file} --quiet --out {out}"),
            0,
        );
        place.collected(out, "swing", 0);
    }
    let of = |out: &str| numbers(&place.path(out).join("swing.points.parquet"));
    assert_eq!(of("a"), of("b"));
    assert_eq!(of("a")[0], ("length".to_owned(), vec![100.0, 250.0]));
    let said = place.says(
        "run swing.eng --analysis swing --design b/swing.points.parquet --out c",
        2,
    );
    assert!(said.contains("holds texts, not numbers"), "{said}");
}

#[test]
fn parts_of_other_studies_are_refused() {
    let place = Place::new("others", "50 ms");
    let says = |words: &str, message: &str| {
        let said = place.says(words, 2);
        assert!(said.contains(message), "{words}: {said}");
    };
    says("status .", "no study was begun in this folder");
    says(
        "collect . --analysis swing",
        "no study was begun in this folder",
    );
    place.says(&format!("{RUN} --slice 1/2 --out out"), 1);
    says(
        "collect out --analysis lengths",
        "it has no study of lengths; it has swing",
    );
    says("collect out", "6 of 12 points are missing: 7..12; run them");
    assert!(!place.path("out/swing.points.parquet").exists());
    place.says("collect out --partial", 1);
    // another text, other settings, another design
    let text = std::fs::read_to_string(place.path("swing.eng")).unwrap();
    std::fs::write(place.path("swing.eng"), text.replace("30 deg", "31 deg")).unwrap();
    says(
        &format!("{RUN} --slice 2/2 --out out"),
        "points of another study: the text of the model has changed",
    );
    place.says(&format!("{RUN} --slice 2/2 --out other"), 0);
    std::fs::write(place.path("swing.eng"), &text).unwrap();
    says(
        &format!("{RUN} --step 1ms --slice 2/2 --out out"),
        "settings or meshes have changed",
    );
    std::fs::write(place.path("design.csv"), DESIGN.replace("1200,1", "1201,1")).unwrap();
    says(
        &format!("{RUN} --slice 2/2 --out out"),
        "values of the design, settings or meshes have changed",
    );
    std::fs::write(place.path("design.csv"), format!("{DESIGN}1300,1\n")).unwrap();
    says(
        &format!("{RUN} --slice 2/2 --out out"),
        "there were 12 points and are 13",
    );
    std::fs::write(place.path("design.csv"), DESIGN).unwrap();
    // a part from elsewhere
    let part = "swing/part-00007-00012.parquet";
    std::fs::copy(place.path("other").join(part), place.path("out").join(part)).unwrap();
    says(
        "collect out",
        "this is a part of another study, of another text of the model",
    );
    says("status out", "part-00007-00012.parquet");
    says(&format!("{RUN} --slice 2/2 --out out"), "move it away");
    // a damaged part
    let bytes = std::fs::read(place.path("out/swing/part-00001-00006.parquet")).unwrap();
    std::fs::write(place.path("out").join(part), &bytes[..bytes.len() / 2]).unwrap();
    says(
        &format!("{RUN} --points failed --out out"),
        "bytes; remove this file, and run the points 7..12 again",
    );
    std::fs::remove_file(place.path("out").join(part)).unwrap();
    place.says(&format!("{RUN} --slice 2/2 --out out"), 0);
    place.says("collect out", 1);
}

#[cfg(unix)]
#[test]
fn one_process_computes_a_part() {
    let place = Place::new("two", "20 s");
    let words = format!("{RUN} --slice 1/1 --out out --threads 1");
    let mut first = place.command(&words).spawn().unwrap();
    wait_for_lines(
        &place.path("out/swing/part-00001-00012.points"),
        2,
        &mut first,
    );
    let said = place.says(&words, 2);
    assert!(
        said.contains("part-00001-00012.points: another run is writing it"),
        "{said}"
    );
    assert!(first.wait().unwrap().code() == Some(1));
    place.says("collect out", 1);
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_no_half_file() {
    let place = Place::new("full", "50 ms");
    place.says(&format!("{RUN} --slice 1/1 --out whole"), 1);
    // the shell's limit on a file's size stands for the disk's
    for blocks in ["1", "2", "4"] {
        let mut limited = Command::new("bash");
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        limited
            .current_dir(&place.0)
            .env("ENG_CACHE", place.path("cache"));
        limited.args(["-c", &script]).arg(env!("CARGO_BIN_EXE_eng"));
        let output = limited
            .args(format!("{RUN} --slice 1/1 --out out").split(' '))
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("part-00001-00012.p"), "{said}");
        let files = place.files("out/swing");
        assert!(
            files
                .iter()
                .all(|name| name == "study.json" || name.ends_with(".points")),
            "{files:?}"
        );
    }
    let standing = place.says("status out", 0);
    assert!(standing.contains("was killed at"), "{standing}");
    place.says(&format!("{RUN} --slice 1/1 --out out"), 1);
    assert!(place.collected("whole", "swing", 1) == place.collected("out", "swing", 1));
    for words in [
        "status out",
        "plan swing.eng --analysis lengths --to slurm",
        "collect out",
    ] {
        let full = std::fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = place.command(words).stdout(full).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{words}: {said}");
        assert!(said.contains("No space left on device"), "{words}: {said}");
    }
}

#[test]
fn scripts_for_schedulers() {
    let place = Place::new("plan", "50 ms");
    for scheduler in ["slurm", "hq", "parallel"] {
        let script = place.says(
            &format!("plan swing.eng --analysis swing --design design.csv --set load=2kg --to {scheduler} --per-task 5 --threads 2"),
            2,
        );
        assert!(script.contains("--set gives it one value"), "{script}");
        let script = place.says(
            &format!("plan swing.eng --analysis lengths --set load=2kg --to {scheduler} --per-task 5 --threads 2"),
            0,
        );
        insta::assert_snapshot!(format!("plan_{scheduler}"), script);
    }
    let script = place.says(
        "plan swing.eng --analysis swing --design design.csv --for parallel --out out",
        0,
    );
    assert!(
        script.contains("12 points of swing in 12 tasks"),
        "{script}"
    );
}
