//! Scratch buffers that threads take in turn.

use super::context::TraceContext;
use super::wavefront::ScratchBuffer;
use std::sync::Mutex;

/// Scratch buffers that no thread is using. Several tracers may take from one pool, so that it holds one buffer for each
/// thread, not for each tracer.
#[derive(Default)]
pub struct ScratchPool(Mutex<Vec<PooledBuffer>>);

/// A buffer, and the number of the tracer that used it last.
struct PooledBuffer {
    tracer: u32,
    buffer: ScratchBuffer,
}

impl ScratchPool {
    /// A buffer for the tracer of this number, whose context is given.
    pub fn take(&self, tracer: u32, context: &TraceContext) -> ScratchBuffer {
        let free = self.0.lock().ok().and_then(|mut free| free.pop());
        let Some(PooledBuffer { tracer: last, mut buffer }) = free else {
            return ScratchBuffer::new(context);
        };
        if last != tracer {
            buffer.fit(context);
        }
        buffer
    }

    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.0.lock().map_or(0, |free| free.len())
    }

    /// Returns a buffer of the tracer of this number.
    pub fn give_back(&self, tracer: u32, buffer: ScratchBuffer) {
        if let Ok(mut free) = self.0.lock() {
            free.push(PooledBuffer { tracer, buffer });
        }
    }
}
