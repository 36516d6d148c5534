//! An importer in Rust: it builds FMUs with the command, unpacks them and calls their functions.

use crate::from_c::{folder, library};
use eng_c::fmi::Instance;
use eng_c::fmi::three::*;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Exit code and text of the command with these words.
pub fn command(words: &[&str]) -> (u8, String) {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut console = eng::cli::Console {
        output: &mut output,
        errors: &mut errors,
        colored_output: false,
        colored_errors: false,
        live: false,
    };
    let words = std::iter::once("eng").chain(words.iter().copied());
    let code = eng::cli::run_on(words.map(Into::into), &mut console);
    let text = [output, errors].concat();
    (code, String::from_utf8(text).expect("a text"))
}

/// An FMU on disk, unpacked, for as long as it is read.
pub struct Fmu {
    pub description: String,
    pub folder: PathBuf,
}

impl Drop for Fmu {
    fn drop(&mut self) {
        // the library of a test build has 100 MB, and a dozen of these would be left
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

impl Fmu {
    /// Builds an FMU of a text. `words` are further words of the command.
    pub fn of(name: &str, text: &str, words: &[&str]) -> Fmu {
        Fmu::in_folder(folder(name), text, words)
    }

    /// [`Fmu::of`] in a folder with further files.
    pub fn in_folder(folder: PathBuf, text: &str, words: &[&str]) -> Fmu {
        let model = folder.join("model.eng");
        std::fs::write(&model, text).expect("a model");
        let packed = folder.join("packed.fmu");
        let library = library();
        let paths = [&model, &packed, &library].map(|path| path.to_str().expect("a text"));
        let mut all = vec![
            "build",
            paths[0],
            "--to",
            "fmu",
            "--out",
            paths[1],
            "--library",
            paths[2],
        ];
        all.extend(words);
        let (code, text) = command(&all);
        assert_eq!(code, 0, "{text}");
        let fmu = Fmu::unpacked(&packed, folder.join("unpacked"));
        std::fs::remove_file(&packed).expect("the archive");
        fmu
    }

    fn unpacked(packed: &Path, folder: PathBuf) -> Fmu {
        let bytes = std::fs::read(packed).expect("the archive");
        let archive = rawzip::ZipArchive::from_slice(&bytes).expect("an archive");
        let mut entries = archive.entries();
        while let Some(entry) = entries.next_entry().expect("an entry") {
            let name = entry
                .file_path()
                .try_normalize()
                .expect("a name")
                .as_ref()
                .to_owned();
            let inner = archive.get_entry(entry.wayfinder()).expect("its data");
            let reader = flate2::bufread::DeflateDecoder::new(inner.data());
            let mut contents = Vec::new();
            inner
                .verifying_reader(reader)
                .read_to_end(&mut contents)
                .expect("undamaged");
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, contents).expect("a file");
        }
        let description =
            std::fs::read_to_string(folder.join("modelDescription.xml")).expect("the description");
        Fmu {
            description,
            folder,
        }
    }

    /// An attribute of the description.
    pub fn attribute(&self, name: &str) -> String {
        let begin = format!(" {name}=\"");
        let (_, rest) = self.description.split_once(&begin).expect(name);
        rest.split('"').next().expect("its end").to_owned()
    }

    /// The value reference of a variable.
    pub fn reference(&self, name: &str) -> u32 {
        let begin = format!("name=\"{name}\" valueReference=\"");
        let (_, rest) = self.description.split_once(&begin).expect(name);
        rest.split('"')
            .next()
            .expect("its end")
            .parse()
            .expect("a number")
    }

    pub fn resources(&self) -> PathBuf {
        self.folder.join("resources")
    }
}

/// Messages of an instance.
type Messages = Vec<String>;

unsafe extern "C" fn told(messages: *mut c_void, _: c_int, _: *const c_char, text: *const c_char) {
    // SAFETY: `Three::new` gives the messages, which live as long as the instance
    let (messages, text) = unsafe { (&mut *messages.cast::<Messages>(), CStr::from_ptr(text)) };
    messages.push(text.to_string_lossy().into_owned());
}

/// An instance by FMI 3.0.
pub struct Three {
    pub instance: *mut Instance,
    messages: *mut Messages,
}

impl Drop for Three {
    fn drop(&mut self) {
        // SAFETY: both are its own
        unsafe {
            fmi3FreeInstance(self.instance);
            drop(Box::from_raw(self.messages));
        }
    }
}

impl Three {
    /// A new instance; its pointer is null if the FMU refuses.
    pub fn with(fmu: &Fmu, token: &str) -> Three {
        let text = |text: &str| CString::new(text).expect("no zero byte");
        let messages: *mut Messages = Box::into_raw(Box::default());
        let (name, token) = (text("one"), text(token));
        let resources = text(fmu.resources().to_str().expect("a text"));
        // SAFETY: all pointers live during the call, the messages as long as the instance
        let instance = unsafe {
            fmi3InstantiateCoSimulation(
                name.as_ptr(),
                token.as_ptr(),
                resources.as_ptr(),
                false,
                true,
                false,
                false,
                std::ptr::null(),
                0,
                messages.cast(),
                Some(told),
                None,
            )
        };
        Three { instance, messages }
    }

    pub fn new(fmu: &Fmu) -> Three {
        let made = Three::with(fmu, &fmu.attribute("instantiationToken"));
        assert!(!made.instance.is_null(), "{:?}", made.messages());
        made
    }

    /// The messages since the last call.
    pub fn messages(&self) -> Messages {
        // SAFETY: they live as long as the instance, which is not in a call
        std::mem::take(unsafe { &mut *self.messages })
    }

    /// The message of a refused call.
    pub fn refused(&self, status: c_int) -> String {
        assert_eq!(status, 3, "{:?}", self.messages());
        self.messages().join("\n")
    }

    /// Checks the status of a call.
    pub fn done(&self, status: c_int) {
        assert_eq!(status, 0, "{:?}", self.messages());
    }

    pub fn initialize(&self) {
        self.enter();
        self.exit();
    }

    pub fn enter(&self) {
        // SAFETY: the instance lives
        self.done(unsafe {
            fmi3EnterInitializationMode(self.instance, false, 0.0, 0.0, false, 0.0)
        });
    }

    pub fn exit(&self) {
        // SAFETY: the instance lives
        self.done(unsafe { fmi3ExitInitializationMode(self.instance) });
    }

    pub fn set(&self, reference: u32, value: f64) -> c_int {
        // SAFETY: the instance and both numbers live
        unsafe { fmi3SetFloat64(self.instance, &reference, 1, &value, 1) }
    }

    pub fn get(&self, reference: u32) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: the instance and both numbers live
        self.done(unsafe { fmi3GetFloat64(self.instance, &reference, 1, &mut value, 1) });
        value
    }

    pub fn step(&self, from: f64, length: f64) -> c_int {
        let (mut flags, mut last) = ([true; 3], f64::NAN);
        let [event, terminate, early] = &mut flags;
        // SAFETY: the instance and the places live
        let status = unsafe {
            fmi3DoStep(
                self.instance,
                from,
                length,
                true,
                event,
                terminate,
                early,
                &mut last,
            )
        };
        // a discarded step wants to end the simulation
        assert_eq!(flags, [false, status == 2, false]);
        assert!(last.is_finite());
        status
    }

    /// The bytes of the present state.
    pub fn bytes(&self) -> Vec<u8> {
        let (mut state, mut size) = (std::ptr::null_mut(), 0);
        // SAFETY: the instance and the places live
        self.done(unsafe { fmi3GetFMUState(self.instance, &mut state) });
        // SAFETY: as before
        self.done(unsafe { fmi3SerializedFMUStateSize(self.instance, state, &mut size) });
        let mut bytes = vec![0; size];
        // SAFETY: as before
        self.done(unsafe { fmi3SerializeFMUState(self.instance, state, bytes.as_mut_ptr(), size) });
        // SAFETY: as before
        self.done(unsafe { fmi3FreeFMUState(self.instance, &mut state) });
        assert!(state.is_null());
        bytes
    }

    /// Continues from bytes.
    pub fn resume(&self, bytes: &[u8]) -> c_int {
        let mut state = std::ptr::null_mut();
        // SAFETY: the instance and the places live
        let read = unsafe {
            fmi3DeserializeFMUState(self.instance, bytes.as_ptr(), bytes.len(), &mut state)
        };
        if read != 0 {
            return read;
        }
        // SAFETY: as before
        let set = unsafe { fmi3SetFMUState(self.instance, state) };
        // SAFETY: as before
        unsafe { fmi3FreeFMUState(self.instance, &mut state) };
        set
    }
}
