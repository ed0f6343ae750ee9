//! Encodes groups of pictures (GOPs) in parallel on the threads of a pool.
//!
//! Chunks of frames go in, and their streams come out in the order of the frames. No GOP refers to frames of another
//! one, so the streams do not depend on the number of threads.

use rayon::ThreadPool;
use std::collections::VecDeque;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Encodes the next frames of a GOP.
pub type EncodeChunk<T> = Box<dyn FnMut(Vec<T>) -> io::Result<Vec<u8>> + Send>;

/// The GOPs that are being encoded.
pub struct ParallelGops<T> {
    pool: Arc<ThreadPool>,
    /// Chunks that may be in flight before [`ParallelGops::next`] waits for the first of them.
    limit: usize,
    /// One per chunk in flight, in the order of the frames.
    streams: VecDeque<Receiver<io::Result<Vec<u8>>>>,
    /// The GOP that takes the next chunk.
    open: Option<Arc<Gop<T>>>,
}

/// A GOP. Its chunks depend on each other, so at most one thread encodes it at a time.
struct Gop<T> {
    encode: Mutex<EncodeChunk<T>>,
    queue: Mutex<Queue<T>>,
}

struct Queue<T> {
    chunks: VecDeque<Chunk<T>>,
    /// Whether a job of the pool exists that takes all chunks of the queue.
    scheduled: bool,
}

struct Chunk<T> {
    frames: Vec<T>,
    stream: SyncSender<io::Result<Vec<u8>>>,
}

impl<T: Send + 'static> ParallelGops<T> {
    pub fn new(pool: Arc<ThreadPool>, limit: usize) -> Self {
        Self { pool, limit, streams: VecDeque::new(), open: None }
    }

    /// Starts a GOP, which takes the following chunks.
    pub fn start(&mut self, encode: EncodeChunk<T>) {
        let queue = Mutex::new(Queue { chunks: VecDeque::new(), scheduled: false });
        self.open = Some(Arc::new(Gop { encode: Mutex::new(encode), queue }));
    }

    /// Adds a chunk to the GOP that was started last.
    pub fn push(&mut self, frames: Vec<T>) {
        let Some(gop) = &self.open else { return };
        let (stream, receiver) = sync_channel(1);
        self.streams.push_back(receiver);
        let mut queue = lock(&gop.queue);
        queue.chunks.push_back(Chunk { frames, stream });
        if !queue.scheduled {
            queue.scheduled = true;
            let gop = Arc::clone(gop);
            self.pool.spawn(move || gop.run());
        }
    }

    /// Takes the stream of the first chunk in flight. If it is not encoded yet, this returns None, or waits if `limit`
    /// chunks are in flight or `wait` is set.
    pub fn next(&mut self, wait: bool) -> Option<io::Result<Vec<u8>>> {
        let first = self.streams.front()?;
        let wait = wait || self.streams.len() >= self.limit;
        let stream = if wait { first.recv().ok() } else { first.try_recv().ok() };
        if stream.is_some() || wait {
            self.streams.pop_front();
        }
        // The sender was dropped without a stream, so encoding the chunk has panicked.
        stream.or_else(|| wait.then(|| Err(io::Error::other("the video encoder failed"))))
    }
}

impl<T> Gop<T> {
    fn run(&self) {
        let mut encode = lock(&self.encode);
        while let Some(Chunk { frames, stream }) = self.next() {
            // A panic in a job of the pool would abort the process.
            if let Ok(encoded) = catch_unwind(AssertUnwindSafe(|| encode(frames))) {
                // The send fails only if the animation was dropped.
                let _ = stream.send(encoded);
            }
        }
    }

    fn next(&self) -> Option<Chunk<T>> {
        let mut queue = lock(&self.queue);
        let chunk = queue.chunks.pop_front();
        queue.scheduled = chunk.is_some();
        chunk
    }
}

/// Locks a mutex whose data no panic can leave half-changed.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;

    fn pool(threads: usize) -> Arc<ThreadPool> {
        Arc::new(rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool"))
    }

    /// All streams of GOPs of these chunks.
    fn all(
        gops: &mut ParallelGops<u8>,
        chunks: &[&[&[u8]]],
        encode: fn(Vec<u8>) -> io::Result<Vec<u8>>,
    ) -> Vec<u8> {
        let mut bytes = Vec::new();
        for gop in chunks {
            gops.start(Box::new(encode));
            for chunk in *gop {
                gops.push(chunk.to_vec());
                while let Some(stream) = gops.next(false) {
                    bytes.extend(stream.expect("a stream"));
                }
            }
        }
        while let Some(stream) = gops.next(true) {
            bytes.extend(stream.expect("a stream"));
        }
        bytes
    }

    #[test]
    fn streams_keep_the_order_of_the_frames() {
        for (threads, limit) in [(1, 1), (1, 9), (2, 3), (3, 2)] {
            let chunks: [&[&[u8]]; 4] = [&[&[1, 2], &[3]], &[&[4]], &[&[5, 6], &[7], &[8]], &[&[9]]];
            let mut gops = ParallelGops::new(pool(threads), limit);
            let slow_first = |frames: Vec<u8>| {
                std::thread::sleep(std::time::Duration::from_millis(u64::from(10 - frames[0])));
                Ok(frames)
            };
            assert_eq!(all(&mut gops, &chunks, slow_first), [1, 2, 3, 4, 5, 6, 7, 8, 9]);
        }
    }

    #[test]
    fn gops_are_encoded_at_the_same_time() {
        let mut gops = ParallelGops::new(pool(2), 4);
        let barrier = Arc::new(Barrier::new(2));
        for k in 0..2 {
            let barrier = Arc::clone(&barrier);
            // Neither returns before the other has begun.
            gops.start(Box::new(move |frames| {
                barrier.wait();
                Ok(frames)
            }));
            gops.push(vec![k]);
        }
        assert_eq!(
            [gops.next(true), gops.next(true)].map(|s| s.expect("a stream").expect("bytes")),
            [[0], [1]]
        );
        assert!(gops.next(true).is_none());
    }

    #[test]
    fn a_panic_is_an_error() {
        let mut gops = ParallelGops::new(pool(1), 1);
        gops.start(Box::new(|_: Vec<u8>| panic!("on purpose")));
        gops.push(vec![1]);
        assert!(gops.next(false).expect("an end").is_err());
    }
}
