//! The glossary of the report.

/// Terms and their definitions.
pub const GLOSSARY: [(&str, &str); 11] = [
    (
        "error (RMSE)",
        "The typical difference of a pixel's light from the true value: the root of the mean squared difference over \
         all pixels and colours, in linear light. Given as a share of the picture's mean brightness.",
    ),
    (
        "relMSE",
        "The squared difference divided by the square of the pixel's true value (plus 0.01), so that dark parts \
         count as much as bright ones. Plots show its root.",
    ),
    (
        "PSNR",
        "The error of the displayed picture relative to the full range of a display, in decibels; higher is better, \
         and 6 dB halve the error.",
    ),
    (
        "FLIP",
        "How different two pictures look to a person who flips between them on a usual screen: 0 is no difference, 1 \
         is the largest possible one (Andersson and others, 2020).",
    ),
    (
        "noise and bias",
        "Noise comes from random samples, and decreases with more of them. A bias is an error that more samples do \
         not reduce, such as light that too few bounces omit. Noise limits its measurement: if a bias is not \
         significant, the report gives an upper bound.",
    ),
    (
        "difference",
        "By how much the picture changes when something is switched off: the root of the mean square over pixels and \
         colours, without noise, as a share of the mean brightness.",
    ),
    (
        "cost, time",
        "Processor time: the sum over all threads of the time that tracing a frame takes. Divide it by the number of \
         free processors for the wall time.",
    ),
    (
        "efficiency",
        "1 / (squared error x time), as a multiple of that of the file's own setting: twice the efficiency gives the \
         same picture in half the time.",
    ),
    (
        "reference",
        "The true picture, approximated by two long renders with different random numbers. Together they have at least \
         16 times the samples of the settings that are compared with them. The error is the mean product of the \
         differences to both, which cancels their own noise.",
    ),
    (
        "interval",
        "± or bars: if everything was measured again, 95 of 100 intervals would contain the true value. By Student's \
         t or, if few pixels contain most of the error, by the bootstrap.",
    ),
    (
        "Pareto front",
        "The settings that no other setting beats in both error and time. Only these are worth choosing.",
    ),
];
