"""What differs between the chapters and Mitsuba, in sentences for a report's page and for docs/results.md."""

DIFFERENCES = [
    "A sample is a camera sample. In chapters 4 to 6 it has four paths, which share the part from the camera to the first hit; "
    "elsewhere it has one. So samples and paths are stated apart, and only times to the same error compare programs.",
    "From chapter 5 on, Russian roulette ends paths early. Mitsuba follows each path to the maximal length, as the references do.",
    "Mitsuba's integrator is `path`, and `volpath` where glass absorbs: that one follows light through media step by step and is "
    "slower, while the chapters multiply by a factor for each way through glass. `clear_glass` has no absorption, and so `path`.",
    "Mitsuba samples lights and BSDFs and combines both. Chapters 3 to 6 sample lights alone, later ones combine both, too.",
    "The variants LLVM and CUDA compile a kernel for the scene. They do so before the clock runs, and seconds from the command on "
    "have that in the start-up. The chapters' shaders are compiled before as well; both keep what they compiled.",
    "Most samplers of Mitsuba round the number of samples up, and the samples that were taken count. They spread the samples of a "
    "call, and their error falls with the size of a call: they get calls as large as memory allows. Ours are independent.",
    "Random numbers are different ones, so runs with the same seed share nothing but the time at which they were made.",
    "Large pictures are compared with the reference after averaging blocks of pixels, so that their error is that of a small "
    "picture with as many samples in all.",
]
