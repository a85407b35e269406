//! What is no file: pipes, devices, standard output.

use std::io::{self, BufWriter, Cursor, Seek, Write};

use super::Sink;

/// Writes to what cannot go back: as it comes.
pub(super) fn stream(
    stream: &mut dyn Write,
    encode: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
) -> io::Result<()> {
    let mut writer = Forward(BufWriter::new(stream));
    encode(&mut writer)?;
    writer.flush()
}

/// What cannot go back.
struct Forward<'a>(BufWriter<&'a mut dyn Write>);

impl Write for Forward<'_> {
    fn write(&mut self, data: &[u8]) -> io::Result<usize> {
        self.0.write(data)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Seek for Forward<'_> {
    fn seek(&mut self, _: io::SeekFrom) -> io::Result<u64> {
        Err(io::ErrorKind::NotSeekable.into())
    }
}

/// Writes to what cannot go back: all at once.
pub(super) fn write_through(
    stream: &mut dyn Write,
    encode: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
) -> io::Result<()> {
    let mut bytes = Memory(Cursor::new(Vec::new()));
    encode(&mut bytes)?;
    stream.write_all(bytes.0.get_ref())?;
    stream.flush()
}

/// Bytes in memory, which fails where there is none left.
struct Memory(Cursor<Vec<u8>>);

impl Write for Memory {
    fn write(&mut self, data: &[u8]) -> io::Result<usize> {
        let reserved = self.0.get_mut().try_reserve(data.len());
        reserved.map_err(|_| io::ErrorKind::OutOfMemory)?;
        self.0.write(data)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Memory {
    fn seek(&mut self, place: io::SeekFrom) -> io::Result<u64> {
        self.0.seek(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(sink: &mut dyn Sink) -> io::Result<()> {
        sink.write_all(b"___ is new")?;
        sink.rewind()?;
        sink.write_all(b"all")
    }

    #[test]
    fn a_stream_gets_everything_in_order() {
        let mut written = Vec::new();
        write_through(&mut written, write).unwrap();
        assert_eq!(written, b"all is new");
        written.clear();
        let error = stream(&mut written, write).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotSeekable);
        written.clear();
        stream(&mut written, |sink| sink.write_all(b"all")).unwrap();
        assert_eq!(written, b"all");
    }
}
