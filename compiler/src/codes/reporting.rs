//! Reports: what is made of results.

eng_grammar::codes! {
    REPORTING:

    REPORT_SHAPE = "E0801", "a signal, a number, a condition or a figure stands where another of them is due",
        "A channel is a signal: a number at each sample of a run. A value is a number made of it, such as its maximum; a figure draws signals.",
        "report forces { value peak = run.force as kN }",
        "report forces { value peak = maximum(run.force) as kN }";
    REPORT_WORD = "E0802", "an option of a report's function is written with a word it does not know",
        "Windows, axes and scales are chosen by words; the message lists those of the place.",
        "report forces { figure lines = spectrum(run.force, window: hanning) }",
        "report forces { figure lines = spectrum(run.force, window: hann) }";
    REPORT_RUNS = "E0803", "signals of one run or of another number of runs are due",
        "A waterfall shows the runs of a sweep, a list is paired with one of its own length, a turned vector with an angle of its own run.",
        "report speeds { figure map = waterfall(runup[1].force) }",
        "report speeds { figure map = waterfall(runup[*].force) }";
    REPORT_NUMBER = "E0804", "a number of a report lies outside of its range",
        "Limits of filters are above zero and in order, an overlap is below 100 %, a cycle counts from 1.",
        "report forces { value level = rms(band(run.force, 2 kHz, 1 kHz)) }",
        "report forces { value level = rms(band(run.force, 1 kHz, 2 kHz)) }";
    REPORT_IDLE = "W0801", "a report shows nothing, or names no analysis",
        "It is made of results, which are named after their analysis. Without one it says the same whatever was run.",
        "report forces { value bore = 86 mm }",
        "report forces { value peak = maximum(run.force) }";
}
