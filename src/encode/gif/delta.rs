//! Frames of a GIF: the changes from the frame before, compressed.

use crate::encode::movie::difference::{PixelRect, changed};
use gif::{DisposalMethod, Frame};
use std::borrow::Cow;

/// The LZW-compressed frame that turns `old` into `new`, without its delay. `None` if they are equal. Both are palette
/// indices of pictures of `size` pixels. Without `old`, the frame is the whole picture.
///
/// Unchanged pixels inside the changed rectangle become `transparent` if that makes the frame smaller.
pub fn delta(
    old: Option<&[u8]>,
    new: &[u8],
    size: (u16, u16),
    transparent: Option<u8>,
) -> Option<Frame<'static>> {
    let stride = usize::from(size.0);
    let Some(old) = old else {
        let whole = PixelRect { left: 0, top: 0, width: stride, height: usize::from(size.1) };
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

/// The frame of a picture with transparent pixels. It contains the rectangle of its opaque pixels and is cleared before
/// the next frame, so that nothing of `old` shows through. `None` if the pictures are equal.
pub fn replacement(old: Option<&[u8]>, new: &[u8], size: (u16, u16), clear: u8) -> Option<Frame<'static>> {
    if old == Some(new) {
        return None;
    }
    let stride = usize::from(size.0);
    let opaque = changed(&vec![clear; new.len()], new, stride);
    let opaque = opaque.unwrap_or(PixelRect { left: 0, top: 0, width: 1, height: 1 });
    let indices = opaque.rows(new, stride).flatten().copied().collect();
    Some(Frame { dispose: DisposalMethod::Background, ..coded(opaque, indices, Some(clear)) })
}

/// A frame that repeats the picture's first pixel and changes nothing. It extends a delay that is too long for one
/// frame.
pub fn filler(first_pixel: u8) -> Frame<'static> {
    coded(PixelRect { left: 0, top: 0, width: 1, height: 1 }, vec![first_pixel], None)
}

fn coded(rectangle: PixelRect, indices: Vec<u8>, transparent: Option<u8>) -> Frame<'static> {
    // The rectangle is inside a picture whose sides fit into u16.
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
