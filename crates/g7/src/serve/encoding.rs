//! The form in which a client reads a file: as it is, as gzip, as Brotli.
//!
//! `assets` asks here before it sends a file of the page; the rules are those of RFC 9110, 12.5.3.

use axum::http::{HeaderMap, header};

/// A form of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Brotli,
    Gzip,
    Identity,
}

/// All forms, the shortest first.
const ALL: [Encoding; 3] = [Encoding::Brotli, Encoding::Gzip, Encoding::Identity];

impl Encoding {
    /// Its name in the headers.
    pub(super) fn name(self) -> &'static str {
        match self {
            Encoding::Brotli => "br",
            Encoding::Gzip => "gzip",
            Encoding::Identity => "identity",
        }
    }

    /// The ending of the name of a file in this form.
    pub(super) fn ending(self) -> &'static str {
        match self {
            Encoding::Brotli => ".br",
            Encoding::Gzip => ".gz",
            Encoding::Identity => "",
        }
    }
}

/// The forms that a client reads: what it prefers first, of equals the shortest first. Without the header
/// it gets the file as it is; nothing is left if it refuses even that.
pub(super) fn accepted(headers: &HeaderMap) -> Vec<Encoding> {
    let mut said = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|v| v.to_str().ok()).peekable();
    if said.peek().is_none() {
        return vec![Encoding::Identity];
    }
    let said: Vec<(&str, f64)> = said.flat_map(|v| v.split(',')).filter_map(weighed).collect();
    let weight = |name: &str| said.iter().find(|(n, _)| n.eq_ignore_ascii_case(name)).map(|(_, q)| *q);
    let of = |encoding: Encoding| match (weight(encoding.name()), weight("*")) {
        (Some(q), _) | (None, Some(q)) => q,
        // A form that is not named is not accepted. The file as it is, is the last choice.
        (None, None) if encoding == Encoding::Identity => f64::MIN_POSITIVE,
        (None, None) => 0.0,
    };
    let mut wanted: Vec<(Encoding, f64)> =
        ALL.map(|e| (e, of(e))).into_iter().filter(|(_, q)| *q > 0.0).collect();
    wanted.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    wanted.into_iter().map(|(encoding, _)| encoding).collect()
}

/// A name of the header and its weight, which is 1 if none is said; a weight that is no number counts as 0.
fn weighed(part: &str) -> Option<(&str, f64)> {
    let (name, rest) = part.split_once(';').unwrap_or((part, ""));
    let name = name.trim();
    let said = rest.trim().trim_start_matches(['q', 'Q']).trim_start().strip_prefix('=');
    let weight =
        if rest.trim().is_empty() { 1.0 } else { said.and_then(|q| q.trim().parse().ok()).unwrap_or(0.0) };
    (!name.is_empty()).then_some((name, if (0.0..=1.0).contains(&weight) { weight } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    #[test]
    fn a_client_gets_what_it_reads() {
        let cases = [
            ("", "identity"),
            ("identity", "identity"),
            ("gzip", "gzip identity"),
            ("br", "br identity"),
            ("gzip, deflate, br, zstd", "br gzip identity"),
            ("deflate, GZIP", "gzip identity"),
            ("br;q=0.5, gzip;q=0.8, *;q=0.1", "gzip br identity"),
            ("br;q=1.0, gzip;q=0.8, *;q=0.1", "br gzip identity"),
            ("br;q=0, gzip", "gzip identity"),
            ("br; q=0.000, gzip; Q=0", "identity"),
            ("*", "br gzip identity"),
            ("*;q=0", ""),
            ("*;q=0, br", "br"),
            ("identity;q=0", ""),
            ("gzip, identity;q=0", "gzip"),
            ("gzip;q=0.5, identity", "identity gzip"),
            ("br;q=x", "identity"),
            ("br;q=7", "identity"),
            ("x-gzip-not, brotli", "identity"),
        ];
        for (said, right) in cases {
            let mut headers = HeaderMap::new();
            headers.insert(header::ACCEPT_ENCODING, HeaderValue::from_static(said));
            let names: Vec<&str> = accepted(&headers).into_iter().map(Encoding::name).collect();
            assert_eq!(names.join(" "), right, "{said:?}");
        }
        assert_eq!(accepted(&HeaderMap::new()), [Encoding::Identity]);
    }

    #[test]
    fn lines_of_the_header_are_one_list() {
        let mut headers = HeaderMap::new();
        headers.append(header::ACCEPT_ENCODING, HeaderValue::from_static("gzip"));
        headers.append(header::ACCEPT_ENCODING, HeaderValue::from_static("br"));
        assert_eq!(accepted(&headers), ALL);
    }
}
