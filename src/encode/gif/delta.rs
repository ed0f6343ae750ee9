//! One frame of a GIF: what it changes, compressed.

use crate::encode::movie::difference::{Rectangle, changed};
use gif::{DisposalMethod, Frame};
use std::borrow::Cow;

/// The frame that turns `old` into `new`, LZW-coded and without its delay; none if they are equal. Both are
/// palette indices of pictures `size` pixels wide and high. Without `old`, the frame is the whole picture.
///
/// Unchanged pixels inside the changed rectangle become `transparent`, where that makes the frame smaller.
pub fn delta(
    old: Option<&[u8]>,
    new: &[u8],
    size: (u16, u16),
    transparent: Option<u8>,
) -> Option<Frame<'static>> {
    let stride = usize::from(size.0);
    let Some(old) = old else {
        let whole = Rectangle { left: 0, top: 0, width: stride, height: usize::from(size.1) };
        return Some(coded(whole, new.to_vec(), None));
    };
    let rectangle = changed(old, new, stride)?;
    let opaque = coded(rectangle, rectangle.rows(new, stride).flatten().copied().collect(), None);
    let Some(key) = transparent else { return Some(opaque) };
    let pairs = rectangle.rows(old, stride).flatten().zip(rectangle.rows(new, stride).flatten());
    let punched = pairs.map(|(old, new)| if old == new { key } else { *new }).collect();
    let punched = coded(rectangle, punched, Some(key));
    Some(if punched.buffer.len() < opaque.buffer.len() { punched } else { opaque })
}

/// A picture with clear pixels after `old`, from which nothing shows through: what is not clear of it, cut out, to vanish
/// before the next frame. None if they are equal.
pub fn alone(old: Option<&[u8]>, new: &[u8], size: (u16, u16), clear: u8) -> Option<Frame<'static>> {
    if old == Some(new) {
        return None;
    }
    let stride = usize::from(size.0);
    let seen = changed(&vec![clear; new.len()], new, stride);
    let seen = seen.unwrap_or(Rectangle { left: 0, top: 0, width: 1, height: 1 });
    let indices = seen.rows(new, stride).flatten().copied().collect();
    Some(Frame { dispose: DisposalMethod::Background, ..coded(seen, indices, Some(clear)) })
}

/// A frame that changes nothing: the picture's first pixel once more, for the rest of a long hold.
pub fn filler(first_pixel: u8) -> Frame<'static> {
    coded(Rectangle { left: 0, top: 0, width: 1, height: 1 }, vec![first_pixel], None)
}

fn coded(rectangle: Rectangle, indices: Vec<u8>, transparent: Option<u8>) -> Frame<'static> {
    // A rectangle lies within a picture whose sides fit.
    let short = |length: usize| length as u16;
    let mut frame = Frame {
        left: short(rectangle.left),
        top: short(rectangle.top),
        width: short(rectangle.width),
        height: short(rectangle.height),
        dispose: DisposalMethod::Keep,
        transparent,
        buffer: Cow::Owned(indices),
        ..Frame::default()
    };
    frame.make_lzw_pre_encoded();
    frame
}
