//! Bit strings in the spelling of the standard: constants with their type, single bits through a mask.
//!
//! Not every compiler can name a bit of a variable (matiec cannot), so that a bit is printed as what it means.

use g7_model::Type;

/// A constant bit string, as `WORD#16#8`.
fn constant(ty: Type, bits: u64) -> String {
    format!("{ty}#16#{bits:X}")
}

/// A whole number as a constant of a bit string type: `16` becomes `WORD#16#10`.
pub(super) fn literal(text: &str, ty: Type) -> Option<String> {
    text.parse::<u64>().ok().map(|bits| constant(ty, bits))
}

/// A bit of a variable, or of an element of an array.
pub(super) struct Bit {
    name: String,
    ty: Type,
    string: Type,
    mask: u64,
}

impl Bit {
    /// The bit of this number, if the type has bits.
    pub(super) fn of(name: &str, ty: Type, number: &str) -> Option<Bit> {
        let string = ty.bit_string().or(ty.is_bits().then_some(ty))?;
        let mask = 1u64.checked_shl(number.parse().ok()?)?;
        Some(Bit { name: name.to_owned(), ty, string, mask })
    }

    /// The variable as a bit string.
    fn bits(&self) -> String {
        let Bit { name, ty, string, .. } = self;
        if ty == string { name.clone() } else { format!("{ty}_TO_{string}({name})") }
    }

    /// `w.3`, as a comparison.
    pub(super) fn read(&self) -> String {
        let (mask, zero) = (constant(self.string, self.mask), constant(self.string, 0));
        format!("({} AND {mask}) <> {zero}", self.bits())
    }

    /// `w.3 := value`, as an assignment of the whole variable.
    pub(super) fn write(&self, value: &str) -> String {
        let Bit { name, ty, string, mask } = self;
        let all = string.bounds().map_or(0, |(_, most)| most as u64);
        let (bits, others, mask) = (self.bits(), constant(*string, all ^ mask), constant(*string, *mask));
        let chosen = format!("SEL({value}, {bits} AND {others}, {bits} OR {mask})");
        if ty == string {
            format!("{name} := {chosen};")
        } else {
            format!("{name} := {string}_TO_{ty}({chosen});")
        }
    }
}
