//! Lines of a chip of this machine, through the kernel's interface for them (Linux GPIO uAPI v2).
//!
//! All lines of a device are asked for at once: outputs begin with their safe values, and a line that
//! another program has is an error of the whole. What talks to the kernel stands behind `Chip`, so that
//! the rest is tested without one.

use gpiocdev::Request;
use gpiocdev::line::{Bias as Resistor, Value, Values};
use gpiocdev::request::Builder;

use crate::device::{Absent, Device, Failed};
use crate::setup::Bias;
use crate::value::Raw;
use crate::wire::{Line, Wire};
use crate::wired::Wired;

/// The lines of a chip that were asked for.
trait Lines: Send {
    /// The level of each line, by its number, in the order of `offsets`.
    fn read(&self, offsets: &[u32]) -> Result<Vec<bool>, Failed>;
    /// Sets lines, all at once.
    fn write(&self, levels: &[(u32, bool)]) -> Result<(), Failed>;
}

/// A chip, as far as lines are asked for.
trait Chip: Send {
    /// Asks for all lines: inputs, and outputs with their first values.
    fn ask(&self, inputs: &[Line], outputs: &[(Line, bool)]) -> Result<Box<dyn Lines>, Failed>;
}

/// A chip of the kernel, by its device file. `as_is` leaves the direction of the lines as it is.
struct Kernel {
    path: String,
    as_is: bool,
}

fn failed(error: &gpiocdev::Error) -> Failed {
    Failed(error.to_string())
}

fn configure(builder: &mut Builder, line: &Line) {
    builder.with_line(line.offset);
    if line.active_low {
        builder.as_active_low();
    }
    if let Some(bias) = line.bias {
        builder.with_bias(match bias {
            Bias::Up => Resistor::PullUp,
            Bias::Down => Resistor::PullDown,
            Bias::None => Resistor::Disabled,
        });
    }
    if let Some(time) = line.debounce {
        builder.with_debounce_period(std::time::Duration::from_nanos(time.count().max(0).unsigned_abs()));
    }
}

impl Chip for Kernel {
    fn ask(&self, inputs: &[Line], outputs: &[(Line, bool)]) -> Result<Box<dyn Lines>, Failed> {
        let mut builder = Request::builder();
        builder.on_chip(self.path.as_str()).with_consumer("g7");
        for line in inputs {
            configure(&mut builder, line);
            if self.as_is {
                builder.as_is();
            } else {
                builder.as_input();
            }
        }
        for (line, on) in outputs {
            configure(&mut builder, line);
            builder.as_output(Value::from(*on));
        }
        let request = builder.request().map_err(|e| failed(&e))?;
        Ok(Box::new(Asked(request)))
    }
}

/// Lines that the kernel has given.
struct Asked(Request);

impl Lines for Asked {
    fn read(&self, offsets: &[u32]) -> Result<Vec<bool>, Failed> {
        let mut values = Values::from_offsets(offsets);
        self.0.values(&mut values).map_err(|e| failed(&e))?;
        Ok(offsets.iter().map(|offset| values.get(*offset) == Some(Value::Active)).collect())
    }

    fn write(&self, levels: &[(u32, bool)]) -> Result<(), Failed> {
        let mut values = Values::default();
        for (offset, on) in levels {
            values.set(*offset, Value::from(*on));
        }
        self.0.set_values(&values).map_err(|e| failed(&e))
    }
}

/// A chip as a device.
struct Board<C> {
    chip: C,
    inputs: Vec<Line>,
    /// Each with its safe value.
    outputs: Vec<(Line, bool)>,
    lines: Option<Box<dyn Lines>>,
}

/// A chip that is wired.
pub(crate) fn device(path: &str, wired: &Wired) -> Box<dyn Device> {
    Box::new(board(Kernel { path: path.to_owned(), as_is: false }, wired))
}

/// A chip that is only looked at: no line changes its direction.
pub(crate) fn look(path: &str, wired: &Wired) -> Box<dyn Device> {
    Box::new(board(Kernel { path: path.to_owned(), as_is: true }, wired))
}

fn board<C: Chip>(chip: C, wired: &Wired) -> Board<C> {
    let line = |wire: &Wire| if let Wire::Line(line) = wire { Some(*line) } else { None };
    let outputs = wired.outputs.iter().filter_map(|o| {
        let safe = o.out.scaling.raw(o.out.safe.unwrap_or(0)).0;
        Some((line(&o.wire)?, safe == Raw::Bit(true)))
    });
    Board {
        chip,
        inputs: wired.inputs.iter().filter_map(|i| line(&i.wire)).collect(),
        outputs: outputs.collect(),
        lines: None,
    }
}

impl<C: Chip> Device for Board<C> {
    fn connect(&mut self) -> Result<(), Failed> {
        // The lines of an earlier attempt would be taken by this program itself.
        self.lines = None;
        self.lines = Some(self.chip.ask(&self.inputs, &self.outputs)?);
        Ok(())
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        _: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let lines = self.lines.as_ref().ok_or_else(|| Failed("its lines were not asked for".to_owned()))?;
        let wanted = self.outputs.iter().zip(outputs).zip(write).filter(|(_, write)| **write);
        let levels: Vec<(u32, bool)> =
            wanted.map(|(((line, _), raw), _)| (line.offset, *raw == Raw::Bit(true))).collect();
        if !levels.is_empty() {
            lines.write(&levels)?;
        }
        if !self.inputs.is_empty() {
            let offsets: Vec<u32> = self.inputs.iter().map(|line| line.offset).collect();
            for (to, on) in inputs.iter_mut().zip(lines.read(&offsets)?) {
                *to = Ok(Raw::Bit(on));
            }
        }
        Ok(())
    }

    /// Gives the lines back: the kernel decides what they have then.
    fn close(&mut self) {
        self.lines = None;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::{Arc, Mutex};

    use super::*;

    /// A chip of numbers: the level of each line, and true for an output.
    #[derive(Clone, Default)]
    struct Paper(Arc<Mutex<BTreeMap<u32, (bool, bool)>>>);

    impl Chip for Paper {
        fn ask(&self, inputs: &[Line], outputs: &[(Line, bool)]) -> Result<Box<dyn Lines>, Failed> {
            let mut lines = self.0.lock().expect("nobody panics");
            if inputs.iter().any(|line| line.offset > 31) {
                return Err(Failed("no such line".to_owned()));
            }
            for line in inputs {
                lines.entry(line.offset).or_default().1 = false;
            }
            for (line, on) in outputs {
                lines.insert(line.offset, (*on, true));
            }
            Ok(Box::new(self.clone()))
        }
    }

    impl Lines for Paper {
        fn read(&self, offsets: &[u32]) -> Result<Vec<bool>, Failed> {
            let lines = self.0.lock().expect("nobody panics");
            Ok(offsets.iter().map(|offset| lines[offset].0).collect())
        }

        fn write(&self, levels: &[(u32, bool)]) -> Result<(), Failed> {
            let mut lines = self.0.lock().expect("nobody panics");
            for (offset, on) in levels {
                let line = lines.get_mut(offset).filter(|line| line.1);
                line.ok_or_else(|| Failed("it is no output".to_owned()))?.0 = *on;
            }
            Ok(())
        }
    }

    fn line(offset: u32) -> Line {
        Line { offset, bias: None, active_low: false, debounce: None }
    }

    #[test]
    fn outputs_begin_with_their_safe_values_and_inputs_are_read_as_they_are() {
        let chip = Paper::default();
        chip.0.lock().expect("free").insert(4, (true, false));
        let outputs = vec![(line(17), true), (line(18), false)];
        let mut board = Board { chip: chip.clone(), inputs: vec![line(4), line(5)], outputs, lines: None };
        let mut inputs = vec![Err(Absent::Unread); 2];
        assert!(board.exchange(&[], &[], &mut inputs, &mut []).is_err(), "not asked for yet");
        board.connect().expect("the lines are free");
        let level = |offset: u32| chip.0.lock().expect("free")[&offset].0;
        assert!(level(17) && !level(18), "safe before the first exchange");
        let values = [Raw::Bit(false), Raw::Bit(true)];
        board.exchange(&values, &[true, false], &mut inputs, &mut [None, None]).expect("done");
        assert!(!level(17) && !level(18), "only what is to be written is written");
        assert_eq!(inputs, [Ok(Raw::Bit(true)), Ok(Raw::Bit(false))]);
        board.close();
        assert!(board.exchange(&values, &[true, true], &mut inputs, &mut []).is_err());
    }

    #[test]
    fn a_chip_that_is_not_there_or_lacks_a_line_is_an_error() {
        let chip = Paper::default();
        let mut board = Board { chip, inputs: vec![line(40)], outputs: Vec::new(), lines: None };
        assert_eq!(board.connect(), Err(Failed("no such line".to_owned())));
        let kernel = Kernel { path: "/dev/g7-has-no-such-chip".to_owned(), as_is: false };
        let mut board = Board { chip: kernel, inputs: vec![line(4)], outputs: Vec::new(), lines: None };
        assert!(board.connect().is_err());
    }
}
