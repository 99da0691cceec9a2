//! The zip archive, as FMI wants it: deflate, version 2.0, no links, forward slashes.

use super::date::Date;
use amontons::Error;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

pub(super) struct Archive {
    writer: ZipWriter<Cursor<Vec<u8>>>,
    options: SimpleFileOptions,
}

impl Archive {
    /// An empty archive whose entries all carry `date`, or the earliest that a zip can hold.
    pub(super) fn new(date: Option<&Date>) -> Self {
        let time = date.map_or_else(DateTime::default, |date| date.in_archive);
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(time)
            // Whatever system this is: the bytes are to be the same.
            .system(System::Unix)
            .unix_permissions(0o644);
        Self { writer: ZipWriter::new(Cursor::new(Vec::new())), options }
    }

    pub(super) fn add(&mut self, name: &str, content: &[u8]) -> Result<(), Error> {
        self.writer.start_file(name, self.options).map_err(|error| failed(&error))?;
        self.writer.write_all(content).map_err(|error| failed(&error))
    }

    pub(super) fn finish(self) -> Result<Vec<u8>, Error> {
        Ok(self.writer.finish().map_err(|error| failed(&error))?.into_inner())
    }
}

fn failed(error: &dyn std::error::Error) -> Error {
    Error::package(format!("cannot write the archive: {error}"))
}
