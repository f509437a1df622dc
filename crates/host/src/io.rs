//! The physical channels behind inputs and outputs.

/// Why a channel could not be read or written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IoError {
    /// The channel, if it is known.
    pub channel: Option<u32>,
    /// The message of the device.
    pub what: String,
}

impl std::fmt::Display for IoError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.channel {
            Some(channel) => write!(f, "channel {channel}: {}", self.what),
            None => f.write_str(&self.what),
        }
    }
}

impl std::error::Error for IoError {}

/// A device: it holds one word for each word of the program's inputs and outputs.
pub trait Io {
    /// Reads every input channel.
    ///
    /// # Errors
    ///
    /// The device cannot be read.
    fn read(&mut self, inputs: &mut [u64]) -> Result<(), IoError>;
    /// Writes every output channel.
    ///
    /// # Errors
    ///
    /// The device cannot be written.
    fn write(&mut self, outputs: &[u64]) -> Result<(), IoError>;
}

/// A device whose inverted channels carry the complement of a BOOL.
///
/// The program sees logical values only; this is the one place where they are inverted.
#[derive(Clone, Debug)]
pub struct Channels<I> {
    device: I,
    inverted_inputs: Vec<usize>,
    inverted_outputs: Vec<usize>,
    raw: Vec<u64>,
}

impl<I: Io> Channels<I> {
    /// Wraps a device; the lists hold the numbers of the inverted words.
    pub fn new(device: I, inverted_inputs: Vec<usize>, inverted_outputs: Vec<usize>) -> Channels<I> {
        Channels { device, inverted_inputs, inverted_outputs, raw: Vec::new() }
    }

    /// The wrapped device.
    pub fn device(&mut self) -> &mut I {
        &mut self.device
    }
}

fn complement(words: &mut [u64], which: &[usize]) {
    for &i in which {
        if let Some(word) = words.get_mut(i) {
            *word ^= 1;
        }
    }
}

impl<I: Io> Io for Channels<I> {
    fn read(&mut self, inputs: &mut [u64]) -> Result<(), IoError> {
        self.device.read(inputs)?;
        complement(inputs, &self.inverted_inputs);
        Ok(())
    }

    fn write(&mut self, outputs: &[u64]) -> Result<(), IoError> {
        self.raw.clear();
        self.raw.extend_from_slice(outputs);
        complement(&mut self.raw, &self.inverted_outputs);
        self.device.write(&self.raw)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Wires {
        inputs: Vec<u64>,
        outputs: Vec<u64>,
    }

    impl Io for Wires {
        fn read(&mut self, inputs: &mut [u64]) -> Result<(), IoError> {
            inputs.copy_from_slice(&self.inputs);
            Ok(())
        }
        fn write(&mut self, outputs: &[u64]) -> Result<(), IoError> {
            self.outputs = outputs.to_vec();
            Ok(())
        }
    }

    #[test]
    fn inverted_channels_carry_the_complement_and_only_they() {
        let wires = Wires { inputs: vec![1, 1, 0], ..Wires::default() };
        let mut channels = Channels::new(wires, vec![0, 2], vec![1]);
        let mut seen = [9; 3];
        channels.read(&mut seen).unwrap();
        assert_eq!(seen, [0, 1, 1]);
        channels.write(&[1, 1]).unwrap();
        assert_eq!(channels.device().outputs, [1, 0]);
    }
}
