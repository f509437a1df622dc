//! Many pages of an operator at once, in one thread, each as cheap for the machine as it can be: it opens its
//! WebSocket, asks to watch, answers pings, and counts frames without reading what is in them. Others fall
//! silent: they never read.

use std::io::{self, ErrorKind};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use tokio::net::TcpStream;

/// The counters of a crowd.
#[derive(Debug, Default)]
struct Counts {
    entered: AtomicU64,
    refused: AtomicU64,
    frames: AtomicU64,
    /// Pages that read and were closed by the server.
    closed: AtomicU64,
    over: AtomicBool,
}

/// Pages at work; they leave as it is dropped.
#[derive(Debug)]
pub struct Crowd {
    counts: Arc<Counts>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Crowd {
    /// So many pages that read enter one after the other, then so many that never do.
    ///
    /// # Errors
    ///
    /// The system has no thread for them.
    pub fn enter(address: SocketAddr, token: &str, readers: u64, mute: u64) -> io::Result<Crowd> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (counts, token) = (Arc::new(Counts::default()), token.to_owned());
        let own = Arc::clone(&counts);
        let pages = async move {
            for number in 0..readers + mute {
                match open(address, &token).await {
                    Err(_) => own.refused.fetch_add(1, Ordering::Relaxed),
                    Ok(stream) => {
                        let counts = Arc::clone(&own);
                        tokio::spawn(async move {
                            if number < readers {
                                read(&stream, &counts).await.ok();
                                counts.closed.fetch_add(1, Ordering::Relaxed);
                            } else {
                                // The socket stays open, and nothing takes what comes.
                                std::future::pending::<()>().await;
                                drop(stream);
                            }
                        });
                        own.entered.fetch_add(1, Ordering::Relaxed)
                    }
                };
            }
            while !own.over.load(Ordering::Acquire) {
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
        };
        let thread =
            std::thread::Builder::new().name("crowd".to_owned()).spawn(move || runtime.block_on(pages))?;
        Ok(Crowd { counts, thread: Some(thread) })
    }

    /// The pages that have entered, and those that were refused.
    pub fn entered(&self) -> (u64, u64) {
        (self.counts.entered.load(Ordering::Relaxed), self.counts.refused.load(Ordering::Relaxed))
    }

    /// The frames that all pages have got.
    pub fn frames(&self) -> u64 {
        self.counts.frames.load(Ordering::Relaxed)
    }

    /// The pages that read, and were closed by the server all the same.
    pub fn closed(&self) -> u64 {
        self.counts.closed.load(Ordering::Relaxed)
    }
}

impl Drop for Crowd {
    fn drop(&mut self) {
        self.counts.over.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

/// Opens a WebSocket and asks to watch.
async fn open(address: SocketAddr, token: &str) -> io::Result<TcpStream> {
    let stream = TcpStream::connect(address).await?;
    let head = format!(
        "GET /api/live?token={token} HTTP/1.1\r\nHost: {address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    );
    send(&stream, head.as_bytes()).await?;
    // Byte for byte, since a first ping may follow the head at once.
    let (mut answer, mut byte) = (Vec::new(), [0]);
    while !answer.ends_with(b"\r\n\r\n") {
        receive(&stream, &mut byte).await?;
        answer.extend_from_slice(&byte);
    }
    if !answer.starts_with(b"HTTP/1.1 101") {
        return Err(ErrorKind::ConnectionRefused.into());
    }
    send(&stream, &frame(1, br#"{"id":1,"call":{"do":"operator_watch"}}"#)).await?;
    Ok(stream)
}

/// A frame of a client (RFC 6455): masked, here by zeros. The payload is shorter than 126 bytes.
fn frame(opcode: u8, payload: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0x80 | opcode, 0x80 | payload.len() as u8, 0, 0, 0, 0];
    bytes.extend_from_slice(payload);
    bytes
}

async fn send(stream: &TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        stream.writable().await?;
        match stream.try_write(bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(e) if e.kind() == ErrorKind::WouldBlock => {}
            Err(e) => return Err(e),
        }
    }
    Ok(())
}

/// At least one byte.
async fn receive(stream: &TcpStream, bytes: &mut [u8]) -> io::Result<usize> {
    loop {
        stream.readable().await?;
        match stream.try_read(bytes) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Err(e) if e.kind() == ErrorKind::WouldBlock => {}
            done => return done,
        }
    }
}

/// Counts frames and answers pings until the server closes.
async fn read(stream: &TcpStream, counts: &Counts) -> io::Result<()> {
    let (mut frames, mut bytes) = (Frames::default(), vec![0; 4096]);
    loop {
        let count = receive(stream, &mut bytes).await?;
        let mut pongs = Vec::new();
        let mut texts = 0;
        frames.feed(&bytes[..count], |opcode, payload| match opcode {
            9 => pongs.extend(frame(10, payload)),
            1 => texts += 1,
            _ => {}
        });
        counts.frames.fetch_add(texts, Ordering::Relaxed);
        send(stream, &pongs).await?;
    }
}

/// The frames of a server in the bytes as they come; the payload of texts is left out.
#[derive(Debug, Default)]
struct Frames {
    head: Vec<u8>,
    /// Bytes of the payload that are still to come; `None` while the head is not whole.
    left: Option<u64>,
    control: Vec<u8>,
}

impl Frames {
    fn feed(&mut self, mut bytes: &[u8], mut whole: impl FnMut(u8, &[u8])) {
        loop {
            if self.left.is_none() {
                let Some((first, rest)) = bytes.split_first() else { return };
                self.head.push(*first);
                bytes = rest;
                self.left = length(&self.head);
            }
            let Some(left) = self.left else { continue };
            let (now, rest) = bytes.split_at(bytes.len().min(usize::try_from(left).unwrap_or(usize::MAX)));
            let opcode = self.head[0] & 15;
            if opcode >= 8 {
                self.control.extend_from_slice(now);
            }
            bytes = rest;
            self.left = Some(left - now.len() as u64);
            if self.left != Some(0) {
                return;
            }
            whole(opcode, &self.control);
            self.head.clear();
            self.control.clear();
            self.left = None;
        }
    }
}

/// The length of the payload, as soon as the head is whole.
fn length(head: &[u8]) -> Option<u64> {
    let short = head.get(1)? & 127;
    let long = match short {
        126 => head.get(2..4)?,
        127 => head.get(2..10)?,
        _ => return Some(u64::from(short)),
    };
    Some(long.iter().fold(0, |length, byte| length << 8 | u64::from(*byte)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_found_wherever_the_bytes_are_cut() {
        let mut bytes = vec![0x81, 3, b'a', b'b', b'c', 0x89, 2, 7, 8, 0x81, 126, 1, 0];
        bytes.extend([b'x'; 256]);
        bytes.extend([0x81, 0, 0x81, 127, 0, 0, 0, 0, 0, 0, 0, 1, b'y']);
        for cut in 1..bytes.len() {
            let (mut frames, mut found) = (Frames::default(), Vec::new());
            for part in bytes.chunks(cut) {
                frames.feed(part, |opcode, payload| found.push((opcode, payload.to_vec())));
            }
            let text = (1, Vec::new());
            assert_eq!(found, [text.clone(), (9, vec![7, 8]), text.clone(), text.clone(), text], "{cut}");
        }
    }
}
