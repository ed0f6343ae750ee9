//! What the words of the report mean.

/// What a reader has to know about each number.
pub const WORDS: [(&str, &str); 11] = [
    (
        "error (RMSE)",
        "How far the light of a pixel is from what it should be, typically: the root of the mean of the squared \
         differences, over all pixels and colours, in linear light. Given as a share of the picture's mean brightness.",
    ),
    (
        "relMSE",
        "The same squared difference divided by the square of what the pixel should be (plus 0.01), so that dark parts \
         count as much as bright ones. Plots show its root.",
    ),
    (
        "PSNR",
        "The error of the displayed picture against the full range of a display, in decibels; higher is better, 6 dB are \
         half the error.",
    ),
    (
        "FLIP",
        "How different two pictures look to a person who flips between them on a usual screen: 0 is no difference, 1 the \
         largest there is (Andersson and others, 2020).",
    ),
    (
        "noise and bias",
        "Noise comes from random samples; more samples take it away. A bias is what stays however many samples there \
         are, such as light that too few bounces leave out. It is measured with noise in it, so that a small one cannot be \
         told from none: then the report says under what it is.",
    ),
    (
        "difference",
        "By how much the picture changes when something is switched off: the root of the mean square over pixels and \
         colours, without noise, as a share of the mean brightness.",
    ),
    (
        "cost, time",
        "Processor time: what all threads together spend on tracing a frame. Divide it by the number of free processors \
         for the time on the wall.",
    ),
    (
        "efficiency",
        "1 / (squared error x time), as a multiple of the file's own: twice the efficiency is the same picture in half \
         the time.",
    ),
    (
        "reference",
        "What the picture should be: two long renders with random numbers of their own, together of at least 16 times the \
         samples of what they judge. Multiplying the differences to both leaves the references' own noise out.",
    ),
    (
        "interval",
        "± or bars: if everything was measured again, 95 of 100 times the true value would lie within. By Student's t or, \
         where few pixels hold most of the error, by the bootstrap.",
    ),
    (
        "Pareto front",
        "Settings that no other one beats in both error and time. Only these are worth choosing.",
    ),
];
