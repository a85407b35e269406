//! A place in the bytes of a file, from which nothing is read beyond their end.

use glam::DVec3;

use super::super::{Fault, Read};
use super::Metadata;
use crate::shown::shown;

#[derive(Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// What is read, for messages.
    part: String,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8], part: &str) -> Self {
        Self {
            bytes,
            at: 0,
            part: part.to_owned(),
        }
    }

    /// Says what is wrong, and where.
    pub(super) fn fault(&self, message: &str) -> Fault {
        format!(": byte {}, \"{}\": {message}", self.at, shown(&self.part)).into()
    }

    pub(super) fn seek(&mut self, place: u64) -> Read<()> {
        match usize::try_from(place) {
            Ok(place) if place <= self.bytes.len() => {
                self.at = place;
                Ok(())
            }
            _ => Err(self.fault(&format!(
                "cut short, or damaged: it goes on at byte {place} of {}",
                self.bytes.len()
            ))),
        }
    }

    pub(super) fn take(&mut self, count: usize) -> Read<&'a [u8]> {
        let end = self.at.checked_add(count);
        match end.and_then(|end| self.bytes.get(self.at..end)) {
            Some(bytes) => {
                self.at += count;
                Ok(bytes)
            }
            None => Err(self.fault(&format!(
                "cut short, or damaged: {count} bytes are needed, {} are there",
                self.bytes.len() - self.at
            ))),
        }
    }

    pub(super) fn number<const N: usize>(&mut self) -> Read<[u8; N]> {
        let mut number = [0; N];
        number.copy_from_slice(self.take(N)?);
        Ok(number)
    }

    pub(super) fn word(&mut self) -> Read<u32> {
        self.number().map(u32::from_le_bytes)
    }

    pub(super) fn long(&mut self) -> Read<u64> {
        self.number().map(u64::from_le_bytes)
    }

    pub(super) fn text(&mut self) -> Read<String> {
        let length = self.word()? as usize;
        let bytes = self.take(length)?;
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    pub(super) fn vector(&mut self) -> Read<DVec3> {
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            *number = f64::from_le_bytes(self.number()?);
        }
        Ok(DVec3::from(numbers))
    }

    pub(super) fn floats<const N: usize>(&mut self) -> Read<[f32; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f32::from_le_bytes(self.number()?);
        }
        Ok(numbers)
    }

    /// Reads names, kinds and values.
    pub(super) fn metadata(&mut self) -> Read<Metadata> {
        let mut metadata = Metadata::new();
        for _ in 0..self.word()? {
            let (name, _) = (self.text()?, self.text()?);
            let length = self.word()? as usize;
            metadata.insert(name, self.take(length)?.to_vec());
        }
        Ok(metadata)
    }
}
