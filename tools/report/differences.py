"""What differs between the chapters and Mitsuba, in sentences for a report's page and for docs/results.md."""

DIFFERENCES = [
    "A sample is a camera sample. In chapters with splitting it has four paths, which share the part from the camera to the first "
    "hit. Elsewhere it has one path. So samples and paths have a column each, and only times to the same error compare programs.",
    "In most chapters Russian roulette ends paths early. Mitsuba follows each path to the maximal length, as the references do.",
    "Mitsuba's integrator is `path`. Where glass absorbs light it is `volpath`, which follows light through media step by step and "
    "is slower. The chapters multiply by a factor for each way through glass. The glass of `clear_glass` does not absorb, so Mitsuba "
    "uses `path` there.",
    "Mitsuba samples lights and BSDFs and combines both. So do the chapters from multiple importance sampling on; the "
    "ones before sample lights alone, or bounces alone.",
    "The variants LLVM and CUDA compile a kernel for the scene before the clock runs. The start-up includes this time. The "
    "chapters' shaders are compiled before as well. Both keep what they compiled.",
    "Most samplers of Mitsuba round the number of samples up, and the samples that were taken count. These samplers spread the "
    "samples of a call, so their error falls with the size of a call. They get calls as large as memory allows. Our samples are "
    "independent, but for low-discrepancy points.",
    "The programs use different random numbers. Runs with the same seed share nothing but the time at which they were made.",
    "Before a large picture is compared with the reference, blocks of its pixels are averaged. So its error is that of a small "
    "picture with as many samples in all.",
]
