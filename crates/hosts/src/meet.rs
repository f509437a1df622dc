//! Processes find each other: sockets, and a greeting in which each shows that it does the same work.
//!
//! Each process listens at its own address and calls those before it. A process that was lost comes back
//! at the same address; all others meet it here again.

use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::thread::sleep;
use std::time::Duration;

use crate::Error;

/// The first word of a greeting.
const MAGIC: u64 = 0x6737_7072_6F76_6501;
/// Words of a greeting: the magic word, the program, the work, the number of processes, from, to.
const WORDS: usize = 6;
/// How long a greeting may take.
const GREETING: Duration = Duration::from_secs(2);
/// Parts in which it may come, each within its part of that time: one of ours comes as a whole.
const PARTS: u32 = 4;
/// The time between two attempts to reach the processes that are missing.
const PAUSE: Duration = Duration::from_millis(10);

/// The hashes by which processes see that they run the same search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Work {
    /// A hash of the program that runs: its version.
    pub program: u64,
    /// A hash of the chart and of the options that decide on answers.
    pub task: u64,
}

/// The place of a process among the others.
pub(crate) struct Meeting {
    me: usize,
    addresses: Vec<String>,
    work: Work,
    listener: TcpListener,
}

impl Meeting {
    /// Listens at the own address.
    ///
    /// # Errors
    ///
    /// The address is in use, or is none of this machine.
    pub(crate) fn open(me: usize, addresses: &[String], work: Work) -> Result<Meeting, Error> {
        let address = addresses.get(me).map_or("", String::as_str);
        let cannot = |e: io::Error| {
            let reason = match e.kind() {
                io::ErrorKind::AddrInUse => "another program has this port".to_owned(),
                io::ErrorKind::AddrNotAvailable => "this machine does not have this address".to_owned(),
                _ => plain(&e),
            };
            Error::Usage(format!("process {me} cannot listen at {address}: {reason}"))
        };
        let listener = TcpListener::bind(address).map_err(cannot)?;
        listener.set_nonblocking(true).map_err(cannot)?;
        Ok(Meeting { me, addresses: addresses.to_vec(), work, listener })
    }

    /// Connects with all others; a connection for each process, none for this one. Waits until all are
    /// there, or `stop` ends it.
    ///
    /// # Errors
    ///
    /// A process does other work, or `stop` has ended it.
    pub(crate) fn meet(&self, stop: &dyn Fn() -> bool) -> Result<Vec<Option<TcpStream>>, Error> {
        let mut found: Vec<Option<TcpStream>> = self.addresses.iter().map(|_| None).collect();
        loop {
            let missing = |found: &[Option<TcpStream>]| {
                (0..found.len()).find(|k| *k != self.me && found.get(*k).is_some_and(Option::is_none))
            };
            let Some(first) = missing(&found) else { return Ok(found) };
            if stop() {
                let address = self.addresses.get(first).map_or("", String::as_str);
                return Err(Error::Alone(format!("process {first} at {address} did not come")));
            }
            for (k, address) in self.addresses.iter().enumerate().take(self.me) {
                if let Some(place) = found.get_mut(k).filter(|f| f.is_none()) {
                    *place = self.call(k, address)?;
                }
            }
            while !stop()
                && let Ok((stream, _)) = self.listener.accept()
            {
                if let Some((from, stream)) = self.welcome(stream)? {
                    // The newest counts: the one before belongs to a process that is no more.
                    if let Some(place) = found.get_mut(from) {
                        *place = Some(stream);
                    }
                }
            }
            sleep(PAUSE);
        }
    }

    fn greeting(&self, to: usize) -> [u64; WORDS] {
        let count = self.addresses.len() as u64;
        [MAGIC, self.work.program, self.work.task, count, self.me as u64, to as u64]
    }

    /// Calls a process; nothing if it is not there yet.
    fn call(&self, to: usize, address: &str) -> Result<Option<TcpStream>, Error> {
        let Ok(mut list) = address.to_socket_addrs() else { return Ok(None) };
        let Some(mut stream) = list.find_map(|a| TcpStream::connect_timeout(&a, GREETING).ok()) else {
            return Ok(None);
        };
        let Ok(theirs) = exchange(&mut stream, self.greeting(to)) else { return Ok(None) };
        if theirs[0] != MAGIC {
            return Err(Error::Usage(format!(
                "at {address} is another program, not process {to} of this search"
            )));
        }
        self.same(theirs, to, address)?;
        Ok(Some(stream))
    }

    /// Answers a call; nothing if it is not from a process of ours.
    fn welcome(&self, mut stream: TcpStream) -> Result<Option<(usize, TcpStream)>, Error> {
        let from = stream.peer_addr().map_or_else(|_| "an unknown address".to_owned(), |a| a.to_string());
        if stream.set_nonblocking(false).is_err() {
            return Ok(None);
        }
        let Ok(theirs) = receive(&mut stream) else { return Ok(None) };
        if theirs[0] != MAGIC {
            return Ok(None);
        }
        let them = usize::try_from(theirs[4]).unwrap_or(usize::MAX);
        if send(&mut stream, self.greeting(them)).is_err() {
            return Ok(None);
        }
        self.same(theirs, them, &from)?;
        Ok(Some((them, stream)).filter(|_| them > self.me))
    }

    /// Compares the work of both.
    fn same(&self, theirs: [u64; WORDS], them: usize, place: &str) -> Result<(), Error> {
        let ours = self.greeting(them);
        let expected = [ours[5], ours[4]];
        let reason = if theirs[1] != ours[1] {
            "is another version of g7"
        } else if theirs[3] != ours[3] {
            "has another number of hosts"
        } else if theirs[2] != ours[2] {
            "has another chart, or other options"
        } else if theirs[4..] != expected || them >= self.addresses.len() {
            "has other hosts, or hosts in another order"
        } else {
            return Ok(());
        };
        Err(Error::Usage(format!(
            "process {them} at {place} {reason}; start all with the same files and options"
        )))
    }
}

fn exchange(stream: &mut TcpStream, words: [u64; WORDS]) -> io::Result<[u64; WORDS]> {
    send(stream, words)?;
    receive(stream)
}

fn send(stream: &mut TcpStream, words: [u64; WORDS]) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(GREETING))?;
    stream.write_all(words.map(u64::to_le_bytes).as_flattened())?;
    stream.set_write_timeout(None)
}

fn receive(stream: &mut TcpStream) -> io::Result<[u64; WORDS]> {
    stream.set_read_timeout(Some(GREETING / PARTS))?;
    let mut words = [[0u8; 8]; WORDS];
    let (bytes, mut have) = (words.as_flattened_mut(), 0);
    for _ in 0..PARTS {
        match stream.read(bytes.get_mut(have..).unwrap_or(&mut [])) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(n) => have += n,
            // Which of these it is depends on the system.
            Err(e) if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {}
            Err(e) => return Err(e),
        }
        if have == bytes.len() {
            stream.set_read_timeout(None)?;
            return Ok(words.map(u64::from_le_bytes));
        }
    }
    Err(io::ErrorKind::TimedOut.into())
}

/// The message of the system, without its error number.
pub(crate) fn plain(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::net::{TcpListener, TcpStream};

    use super::{GREETING, PARTS, WORDS, receive, send};

    fn pair() -> (TcpStream, TcpStream) {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let there = TcpStream::connect(listener.local_addr().expect("an address")).expect("it listens");
        (there, listener.accept().expect("it has come").0)
    }

    #[test]
    fn a_greeting_comes_within_its_time_or_not_at_all() {
        let (mut there, mut here) = pair();
        let words: [u64; WORDS] = std::array::from_fn(|k| k as u64);
        send(&mut there, words).expect("it is connected");
        assert_eq!(receive(&mut here).expect("it has come"), words);
        // A stranger who sends one byte after the other: after a few of them it is no more waited for.
        let bytes = std::thread::spawn(move || {
            let mut sent = 0;
            while sent < 8 * WORDS && there.write_all(&[7]).is_ok() {
                sent += 1;
                std::thread::sleep(GREETING / PARTS / 4);
            }
            sent
        });
        let end = receive(&mut here).map_err(|e| e.kind());
        assert_eq!(end, Err(std::io::ErrorKind::TimedOut));
        drop(here);
        let sent = bytes.join().expect("it does not panic");
        assert!(sent < 8 * WORDS, "{sent}");
    }
}
