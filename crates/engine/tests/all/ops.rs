//! Instructions that charts seldom have: tables, texts, random numbers, services.

use crate::common;

use common::chart;
use g7_engine::{
    Addr, Cmp, Code, Duration, FaultKind, Num, Op, Program, Rows, Rules, Service, State, StepId, Tables,
    WORK, eval, scan,
};

/// A program of one step whose variable area is these words, with some code.
fn program(words: &[u64], code: &[Op]) -> (Program, Code) {
    let mut t = chart(Rules::IEC61131, 1, 0, &[0], &[]);
    t.init = words.to_vec();
    t.outputs = Rows::default();
    t.safe = Vec::new();
    t.steps[0].direct = Addr(u32::MAX);
    t.code = code.to_vec();
    let code = Code { start: 0, end: code.len() as u32 };
    (Program::new(t).expect("tables are sound"), code)
}

/// The word that code leaves on the stack, and the words behind it.
fn done(words: &[u64], code: &[Op]) -> (Result<u64, FaultKind>, Vec<u64>) {
    let (p, code) = program(words, code);
    let mut s = State::new(&p);
    let left = eval(&p, &mut s, code).map_err(|f| f.kind);
    (left, s.words().to_vec())
}

#[test]
fn an_index_chooses_one_element_of_its_table() {
    let words = [9, 10, 11, 12, 9];
    let read = |i: i64| done(&words, &[Op::Push(i as u64), Op::LoadAt { base: Addr(1), len: 3 }]).0;
    assert_eq!([read(0), read(1), read(2)], [Ok(10), Ok(11), Ok(12)]);
    let write = |i: i64| {
        let code = [Op::Push(i as u64), Op::Push(77), Op::StoreAt { base: Addr(1), len: 3 }, Op::Push(0)];
        done(&words, &code)
    };
    assert_eq!(write(0), (Ok(0), vec![9, 77, 11, 12, 9]));
    assert_eq!(write(2), (Ok(0), vec![9, 10, 11, 77, 9]));
    for i in [-1, 3, i64::MAX, i64::MIN] {
        assert_eq!(read(i), Err(FaultKind::Range), "read {i}");
        assert_eq!(write(i), (Err(FaultKind::Range), words.to_vec()), "write {i}");
    }
}

#[test]
fn work_has_an_end_and_all_of_it_may_be_used() {
    // Counts down to 0: as many jumps back as the number less one.
    let down = [
        Op::Load(Addr(0)),
        Op::Push(1),
        Op::Arith(g7_engine::Arith::Sub, Num::I64),
        Op::Store(Addr(0)),
        Op::Load(Addr(0)),
        Op::Push(0),
        Op::Compare(Cmp::Eq, Num::I64),
        Op::JumpUnless(0),
        Op::Push(5),
    ];
    let work = u64::from(WORK);
    assert_eq!(done(&[work + 1], &down).0, Ok(5));
    assert_eq!(done(&[work + 2], &down).0, Err(FaultKind::Work));
    assert_eq!(done(&[2 * work], &down).0, Err(FaultKind::Work));
}

#[test]
fn random_numbers_are_those_of_splitmix64() {
    // The first results for the seed 1234567 (Steele, Lea, Flood 2014; test vector of
    // the reference implementation), as fractions of 53 bits.
    let (p, code) = program(&[1_234_567], &[Op::Random(Addr(0))]);
    let mut s = State::new(&p);
    for wanted in [6_457_827_717_110_365_317u64, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423] {
        let word = eval(&p, &mut s, code).expect("no fault");
        assert_eq!(f64::from_bits(word), (wanted >> 11) as f64 / 2f64.powi(53));
    }
}

/// The words of a text variable for so many bytes.
fn text(bytes: &[u8], cap: usize) -> Vec<u64> {
    let mut room = bytes.to_vec();
    room.resize(cap.div_ceil(8) * 8, 0);
    let words = room.chunks(8).map(|c| u64::from_le_bytes(c.try_into().expect("eight bytes")));
    [bytes.len() as u64].into_iter().chain(words).collect()
}

#[test]
fn texts_are_compared_byte_by_byte_to_their_end() {
    let compared = |a: &str, b: &str, c: Cmp| {
        let words = [text(a.as_bytes(), 24), text(b.as_bytes(), 24)].concat();
        done(&words, &[Op::Push(0), Op::Push(4), Op::CompareText(c)]).0
    };
    let pairs = [("a", "b"), ("12345678", "123456789"), ("1234567890123456", "1234567890123457"), ("", "a")];
    for (low, high) in pairs {
        assert_eq!(compared(low, high, Cmp::Lt), Ok(1), "{low} < {high}");
        assert_eq!(compared(high, low, Cmp::Lt), Ok(0), "{high} < {low}");
        assert_eq!(compared(low, low, Cmp::Eq), Ok(1), "{low} = {low}");
        assert_eq!(compared(low, high, Cmp::Eq), Ok(0), "{low} = {high}");
    }
}

#[test]
fn a_text_is_cut_at_a_character() {
    let cut = |bytes: &[u8], cap: u16| {
        let mut words = text(bytes, 16);
        words.extend([0; 3]);
        let to = Addr(3);
        let (left, words) = done(&words, &[Op::Push(0), Op::StoreText { to, cap }, Op::Push(0)]);
        left.map(|_| words[3..].to_vec())
    };
    assert_eq!(cut(b"abcdef", 8), Ok(text(b"abcdef", 16)));
    assert_eq!(cut(b"abcdefgh", 8), Ok(text(b"abcdefgh", 16)));
    assert_eq!(cut(b"abcdefghi", 8), Ok(text(b"abcdefgh", 16)));
    // A character of two bytes does not fit in the one that is left.
    assert_eq!(cut("abcdefgé".as_bytes(), 8), Ok(text(b"abcdefg", 16)));
    assert_eq!(cut("abcdefé".as_bytes(), 8), Ok(text("abcdefé".as_bytes(), 16)));
    // No text at all, but words that came from outside.
    assert_eq!(cut(&[0x80; 12], 8), Ok(text(b"", 16)));
}

/// A number or TIME as text.
fn shown(value: u64, from: Num, time: bool) -> String {
    let to = Addr(0);
    let (_, words) = done(&[0; 6], &[Op::Push(value), Op::ToText { from, time, to, cap: 40 }]);
    let bytes: Vec<u8> = words[1..].iter().flat_map(|w| w.to_le_bytes()).collect();
    String::from_utf8(bytes[..words[0] as usize].to_vec()).expect("a text")
}

#[test]
fn values_are_shown_as_their_type_is_written() {
    assert_eq!([shown(0, Num::Bool, false), shown(1, Num::Bool, false)], ["FALSE", "TRUE"]);
    assert_eq!(shown(-12i64 as u64, Num::I16, false), "-12");
    assert_eq!(shown(u64::MAX, Num::U64, false), "18446744073709551615");
    assert_eq!(shown(u64::from(1.5f32.to_bits()), Num::F32, false), "1.5");
    assert_eq!(shown((-0.25f64).to_bits(), Num::F64, false), "-0.25");
    assert_eq!(shown(1_500_000_000, Num::I64, false), "1500000000");
    assert_eq!(shown(1_500_000_000, Num::I64, true), "T#1s500ms");
}

#[test]
fn a_duration_has_each_unit_once_from_days_to_nanoseconds() {
    let show = |ns: i64| Duration(ns).to_string();
    let (s, m, h, d) = (1_000_000_000, 60_000_000_000, 3_600_000_000_000, 86_400_000_000_000);
    assert_eq!([show(0), show(1), show(-1)], ["T#0s", "T#1ns", "T#-1ns"]);
    assert_eq!(
        [show(1_000), show(1_000_000), show(s), show(m), show(h), show(d)],
        ["T#1us", "T#1ms", "T#1s", "T#1m", "T#1h", "T#1d"]
    );
    assert_eq!(show(2 * d + 3 * h + 4 * m + 5 * s + 6_007_008), "T#2d3h4m5s6ms7us8ns");
    assert_eq!(show(-(m + 2_000_000)), "T#-1m2ms");
    assert_eq!(show(i64::MIN), "T#-106751d23h47m16s854ms775us808ns");
}

/// A text as a number.
fn read(t: &str, to: Num) -> Result<u64, FaultKind> {
    done(&text(t.as_bytes(), 40), &[Op::Push(0), Op::FromText(to)]).0
}

#[test]
fn texts_are_read_as_values_of_a_type() {
    assert_eq!([read("TRUE", Num::Bool), read("1", Num::Bool)], [Ok(1), Ok(1)]);
    assert_eq!([read("FALSE", Num::Bool), read("0", Num::Bool)], [Ok(0), Ok(0)]);
    assert_eq!([read("2", Num::Bool), read("", Num::Bool)], [Err(FaultKind::Range); 2]);
    assert_eq!(read(" 1.5 ", Num::F32), Ok(u64::from(1.5f32.to_bits())));
    assert_eq!(read("-2.5e3", Num::F64), Ok((-2500f64).to_bits()));
    assert_eq!(read("18446744073709551615", Num::U64), Ok(u64::MAX));
    assert_eq!(read("-7", Num::I16), Ok(-7i64 as u64));
    assert_eq!(read("40000", Num::I16), Err(FaultKind::Range));
    assert_eq!([read("1.5", Num::I16), read("x", Num::F64)], [Err(FaultKind::Range); 2]);
}

#[test]
fn reset_xit_sets_the_times_of_every_step_to_zero() {
    // Steps 1 and 3 are active from 10 on, in the place of 0 and 2.
    let arcs = [(vec![0], vec![1], Some(0)), (vec![2], vec![3], Some(0))];
    let mut t: Tables = chart(Rules::IEC61131, 4, 2, &[0, 2], &arcs);
    t.code = vec![Op::Load(Addr(1)), Op::JumpUnless(3), Op::Service(Service::ResetTimes)];
    t.pre = Code { start: 0, end: 3 };
    let p = Program::new(t).expect("tables are sound");
    let mut s = State::new(&p);
    for (inputs, now) in [([0, 0], 0), ([1, 0], 10), ([0, 0], 30)] {
        scan(&p, &mut s, &inputs, now).expect("no fault");
    }
    let steps = |s: &State| [0, 1, 2, 3].map(|i| (s.step_age(&p, StepId(i)), s.step_time(&p, StepId(i))));
    assert_eq!(steps(&s), [(10, 10), (20, 20), (10, 10), (20, 20)]);
    scan(&p, &mut s, &[0, 1], 40).expect("no fault");
    assert_eq!(steps(&s), [(0, 0); 4]);
    scan(&p, &mut s, &[0, 0], 45).expect("no fault");
    assert_eq!(steps(&s), [(0, 0), (5, 5), (0, 0), (5, 5)]);
}
