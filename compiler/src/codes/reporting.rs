//! Codes of reports.

eng_grammar::codes! {
    REPORTING:

    REPORT_SHAPE = "E0801", "a signal, a number, a condition or a figure is used in place of another of them",
        "A channel is a signal: a number at each sample of a run. A value is a number that a function computes from a signal, such as its maximum. A figure draws signals.",
        "report forces { value peak = run.force as kN }",
        "report forces { value peak = maximum(run.force) as kN }";
    REPORT_WORD = "E0802", "an option of a report's function has an unknown word",
        "Words choose windows, axes and scales. The message lists the words that are possible at this place.",
        "report forces { figure lines = spectrum(run.force, window: hanning) }",
        "report forces { figure lines = spectrum(run.force, window: hann) }";
    REPORT_RUNS = "E0803", "a function of reports needs signals of other runs",
        "A waterfall needs the runs of a sweep. Two lists that are combined need one length. A turned vector needs an angle of its own run. A signal is drawn over another one of the same samples.",
        "report speeds { figure map = waterfall(runup[1].force) }",
        "report speeds { figure map = waterfall(runup[*].force) }";
    REPORT_NUMBER = "E0804", "a number of a report lies outside of its range",
        "Limits of filters are above zero and in order, an overlap is below 100 %, a cycle counts from 1.",
        "report forces { value level = rms(band(run.force, 2 kHz, 1 kHz)) }",
        "report forces { value level = rms(band(run.force, 1 kHz, 2 kHz)) }";
    REPORT_GRADIENT = "E0805", "a report differentiates by a parameter, and the analysis does not",
        "A run computes derivatives by the parameters that `gradients` of its `transient` or `periodic` analysis names. The functions `gradient` and `tornado` of reports read these.",
        "analysis run = transient(Cart(), duration: 1 s)\nreport slopes { value by_mass = gradient(maximum(run.force), mass) }",
        "analysis run = transient(Cart(), duration: 1 s, gradients: [mass])\nreport slopes { value by_mass = gradient(maximum(run.force), mass) }";
    REPORT_IDLE = "W0801", "a report shows nothing, or names no analysis",
        "A report evaluates results, and names them by their analysis. A report that names no analysis does not depend on a run.",
        "report forces { value bore = 86 mm }",
        "report forces { value peak = maximum(run.force) }";
}
