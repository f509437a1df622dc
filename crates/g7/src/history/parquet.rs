//! Rows as a file of Parquet, which pandas, DuckDB and Spark read.

use std::io::{self, Write};
use std::sync::Arc;

use g7_host::{Kind, Value};
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::rows::{Row, Sink};

/// Rows of a group: as many as are in memory at once.
const GROUP: usize = 1 << 17;

/// `time` is in UTC, `record` in us of the record. A whole number, a BOOL and a TIME, in ns, stand in
/// `whole` as they are, and each value as a number, a TIME in s, in `value`. Both are null where the value
/// is not known.
const SCHEMA: &str = "message history {
    REQUIRED INT64 time (TIMESTAMP(MICROS, true));
    REQUIRED INT64 record;
    REQUIRED BYTE_ARRAY signal (UTF8);
    OPTIONAL DOUBLE value;
    OPTIONAL INT64 whole;
}";

/// A file of Parquet that is being written.
pub(crate) struct Parquet<W: Write + Send> {
    file: SerializedFileWriter<W>,
    time: Vec<i64>,
    record: Vec<i64>,
    signal: Vec<ByteArray>,
    value: Optional<f64>,
    whole: Optional<i64>,
}

/// A column in which values may be missing: those that are there, and a 1 or 0 for each row.
struct Optional<T> {
    values: Vec<T>,
    there: Vec<i16>,
}

impl<T> Optional<T> {
    fn new() -> Optional<T> {
        Optional { values: Vec::new(), there: Vec::new() }
    }

    fn push(&mut self, value: Option<T>) {
        self.there.push(i16::from(value.is_some()));
        self.values.extend(value);
    }

    fn clear(&mut self) {
        self.values.clear();
        self.there.clear();
    }
}

impl<W: Write + Send> Parquet<W> {
    pub(crate) fn new(out: W) -> io::Result<Parquet<W>> {
        let schema = Arc::new(parse_message_type(SCHEMA).map_err(failed)?);
        let properties = WriterProperties::builder().set_compression(Compression::UNCOMPRESSED).build();
        let file = SerializedFileWriter::new(out, schema, Arc::new(properties)).map_err(failed)?;
        Ok(Parquet {
            file,
            time: Vec::new(),
            record: Vec::new(),
            signal: Vec::new(),
            value: Optional::new(),
            whole: Optional::new(),
        })
    }

    pub(crate) fn end(mut self) -> io::Result<W> {
        self.group().map_err(failed)?;
        self.file.into_inner().map_err(failed)
    }

    /// Writes the rows that wait.
    fn group(&mut self) -> Result<(), ParquetError> {
        if self.time.is_empty() {
            return Ok(());
        }
        let mut group = self.file.next_row_group()?;
        column::<_, Int64Type>(&mut group, &self.time, None)?;
        column::<_, Int64Type>(&mut group, &self.record, None)?;
        column::<_, ByteArrayType>(&mut group, &self.signal, None)?;
        column::<_, DoubleType>(&mut group, &self.value.values, Some(&self.value.there))?;
        column::<_, Int64Type>(&mut group, &self.whole.values, Some(&self.whole.there))?;
        group.close()?;
        self.time.clear();
        self.record.clear();
        self.signal.clear();
        self.value.clear();
        self.whole.clear();
        Ok(())
    }
}

fn column<W: Write + Send, T: DataType>(
    group: &mut parquet::file::writer::SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
    there: Option<&[i16]>,
) -> Result<(), ParquetError> {
    if let Some(mut column) = group.next_column()? {
        column.typed::<T>().write_batch(values, there, None)?;
        column.close()?;
    }
    Ok(())
}

fn failed(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    }
}

impl<W: Write + Send> Sink for Parquet<W> {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        self.time.push(row.utc);
        self.record.push(row.at);
        self.signal.push(row.signal.name.as_str().into());
        self.value.push(row.word.map(|word| Value::Word(word).number(row.signal.kind)));
        self.whole.push(
            row.word.filter(|_| !matches!(row.signal.kind, Kind::Real | Kind::Lreal)).map(u64::cast_signed),
        );
        if self.time.len() >= GROUP {
            self.group().map_err(failed)?;
        }
        Ok(())
    }
}
