//! Guesses of passwords: a bounded number a minute from an address.
//!
//! Addresses of IPv6 count by their network of 64 bits, which one machine may have for itself. Those that were
//! refused are counted, and the count is told once a minute: a flood of guesses is no flood of rows.

use std::collections::BTreeMap;
use std::net::IpAddr;

/// Guesses a minute.
const GUESSES: u32 = 10;
const MINUTE: u64 = 60_000;
/// Addresses that are remembered; beyond them all others share one place.
const ADDRESSES: usize = 10_000;

/// The guesses from the addresses in their present minute.
#[derive(Debug, Default)]
pub(super) struct Throttle(BTreeMap<IpAddr, Minute>);

#[derive(Debug, Default)]
struct Minute {
    begin: u64,
    made: u32,
    refused: u64,
}

impl Throttle {
    /// Counts a guess at an instant in ms; false if there were too many.
    pub(super) fn allows(&mut self, from: IpAddr, now: u64) -> bool {
        let mut key = network(from);
        if self.0.len() >= ADDRESSES && !self.0.contains_key(&key) {
            self.0.retain(|_, minute| now.saturating_sub(minute.begin) < MINUTE || minute.refused > 0);
            if self.0.len() >= ADDRESSES {
                key = IpAddr::from([0, 0, 0, 0]);
            }
        }
        let minute = self.0.entry(key).or_default();
        if now.saturating_sub(minute.begin) >= MINUTE {
            *minute = Minute { begin: now, made: 0, refused: minute.refused };
        }
        if minute.made >= GUESSES {
            minute.refused += 1;
            return false;
        }
        minute.made += 1;
        true
    }

    /// The addresses with guesses that were refused and not told yet, once their minute is over.
    pub(super) fn refused(&mut self, now: u64) -> Vec<(IpAddr, u64)> {
        let over = |minute: &Minute| now.saturating_sub(minute.begin) >= MINUTE;
        let told = self.0.iter_mut().filter(|(_, minute)| over(minute) && minute.refused > 0);
        told.map(|(from, minute)| (*from, std::mem::take(&mut minute.refused))).collect()
    }
}

fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(six) => IpAddr::from((six.to_bits() >> 64 << 64).to_be_bytes()),
        four @ IpAddr::V4(_) => four,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> IpAddr {
        text.parse().expect("an address")
    }

    #[test]
    fn ten_guesses_a_minute_from_an_address() {
        let mut throttle = Throttle::default();
        let made = |throttle: &mut Throttle, from: &str, now: u64| {
            (0..10_000).filter(|_| throttle.allows(at(from), now)).count()
        };
        assert_eq!(made(&mut throttle, "10.0.0.1", 1_000_000), 10);
        assert_eq!(made(&mut throttle, "10.0.0.2", 1_000_000), 10, "another address has its own");
        assert_eq!(made(&mut throttle, "10.0.0.1", 1_059_999), 0);
        assert_eq!(made(&mut throttle, "10.0.0.1", 1_060_000), 10);
        let told = throttle.refused(1_200_000);
        assert_eq!(told, [(at("10.0.0.1"), 29_980), (at("10.0.0.2"), 9_990)]);
        assert!(throttle.refused(1_200_000).is_empty(), "told once");
    }

    #[test]
    fn a_network_of_ipv6_is_one_address_and_a_mapped_one_is_that_of_ipv4() {
        let mut throttle = Throttle::default();
        for k in 0..20 {
            let from = at(&format!("2001:db8::{k:x}"));
            assert_eq!(throttle.allows(from, 100_000), k < 10);
        }
        assert!(throttle.allows(at("2001:db8:0:1::1"), 100_000));
        for k in 0..20 {
            let from = if k % 2 == 0 { "::ffff:10.0.0.9" } else { "10.0.0.9" };
            assert_eq!(throttle.allows(at(from), 100_000), k < 10);
        }
    }

    #[test]
    fn memory_is_bounded_however_many_addresses_come() {
        let mut throttle = Throttle::default();
        for k in 0..ADDRESSES as u32 + 5_000 {
            throttle.allows(IpAddr::from((0x0a00_0000 + k).to_be_bytes()), 100_000);
        }
        assert!(throttle.0.len() <= ADDRESSES + 1);
    }
}
