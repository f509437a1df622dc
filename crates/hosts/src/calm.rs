//! A connection that does not end with a panic.
//!
//! The threads of timely that read and write panic where a connection breaks, and take the process with
//! them. Here a connection that has ended, in good order or not, says so by a flag, which `wire.rs` looks
//! at. The thread that reads sees one that was closed in good order: the message in hand is filled up with
//! zeros, then comes the empty header by which timely ends a stream. The thread that writes sees all of its
//! bytes go.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use timely_communication::allocator::zero_copy::stream::Stream;

/// Bytes of the header of a message, six words: the third and the fourth say for which workers it is, the
/// fifth is the length of what follows.
const HEADER: usize = 48;
/// Most bytes of a message; more are the work of a stranger.
const LONGEST: u64 = 1 << 26;

/// A connection with its flag.
pub(crate) struct Calm {
    me: usize,
    stream: TcpStream,
    gone: Arc<AtomicBool>,
    /// The header in hand, and how much of it the reader has.
    header: [u8; HEADER],
    given: usize,
    /// Bytes of the message that are still to come.
    rest: u64,
    /// The stream has ended.
    over: bool,
}

impl Calm {
    /// A connection of the process with this number; `gone` is set when it has ended.
    pub(crate) fn new(me: usize, stream: TcpStream, gone: Arc<AtomicBool>) -> Calm {
        Calm { me, stream, gone, header: [0; HEADER], given: HEADER, rest: 0, over: false }
    }

    fn end(&mut self) {
        self.gone.store(true, Ordering::SeqCst);
        self.over = true;
    }

    /// Reads the next header as a whole; one of zeros stands for a connection that broke.
    fn next_header(&mut self) {
        let read = self.stream.read_exact(&mut self.header);
        let (words, _) = self.header.as_chunks();
        let word = |k: usize| words.get(k).copied().map_or(0, u64::from_be_bytes);
        let (from, to, length) = (word(2), word(3), word(4));
        let mine = length == 0 || (from == self.me as u64 && to == from + 1);
        if read.is_err() || length > LONGEST || !mine {
            self.end();
            self.header = [0; HEADER];
            self.rest = 0;
        } else {
            self.rest = length;
            if length == 0 {
                self.end();
            }
        }
        self.given = 0;
    }
}

impl Read for Calm {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if into.is_empty() {
            return Ok(0);
        }
        if self.given == HEADER && self.rest == 0 {
            if self.over {
                return Ok(0);
            }
            self.next_header();
        }
        if self.given < HEADER {
            let left = self.header.get(self.given..).unwrap_or(&[]);
            let n = left.len().min(into.len());
            into.iter_mut().zip(left).for_each(|(to, from)| *to = *from);
            self.given += n;
            return Ok(n);
        }
        let most = usize::try_from(self.rest).unwrap_or(usize::MAX).min(into.len());
        let part = into.get_mut(..most).unwrap_or(&mut []);
        let n = match if self.over { Ok(0) } else { self.stream.read(part) } {
            Ok(n) if n > 0 => n,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => return Err(e),
            _ => {
                part.fill(0);
                self.end();
                most
            }
        };
        self.rest -= n as u64;
        if self.rest == 0 && self.over {
            // The message is full of zeros; the header that ends the stream follows.
            (self.header, self.given) = ([0; HEADER], 0);
        }
        Ok(n)
    }
}

impl Write for Calm {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.stream.write(bytes) {
            Ok(n) if n > 0 || bytes.is_empty() => Ok(n),
            Err(e) if e.kind() == io::ErrorKind::Interrupted => Err(e),
            _ => {
                self.end();
                Ok(bytes.len())
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Stream for Calm {
    fn try_clone(&self) -> io::Result<Calm> {
        Ok(Calm::new(self.me, self.stream.try_clone()?, self.gone.clone()))
    }

    fn set_nonblocking(&self, nonblocking: bool) -> io::Result<()> {
        self.stream.set_nonblocking(nonblocking)
    }

    fn shutdown(&self, how: Shutdown) -> io::Result<()> {
        // One that is broken already cannot be closed, nor need it be.
        let _broken = self.stream.shutdown(how);
        Ok(())
    }
}
