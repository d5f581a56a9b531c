//! Voxels as they lie in a file, decoded straight into the array that stays.

use std::fmt;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use bzip2::bufread::MultiBzDecoder;
use flate2::bufread::{MultiGzDecoder, ZlibDecoder};

use super::ReadOptions;
use super::components::{ComponentReader, Components, Pick};
use super::decoded::Decoded;
use super::element::{Element, Stored};
use super::grid::Grid;
use super::narrow::{Narrowed, Wide, not_exact};
use super::parts::Parts;
use super::source::{Source, read_error};
use super::text_data::{AsciiDecoder, HexDecoder};
use crate::error::{Error, Result};
use crate::scene::Endian;
use crate::volume::Voxels;

/// bzip2 puts runs of up to 259 bytes as 5 into blocks of 900,000, and a block of one run into some 40 bytes.
const MAX_BZIP2_RATIO: u64 = 1 << 21;

/// Bytes read at a time: large reads, yet still in the cache when bytes are swapped.
const CHUNK_BYTES: usize = 1 << 20;

/// DEFLATE (RFC 1951, 3.2.5) cannot do better than 258 bytes for two bits.
pub(super) const MAX_DEFLATE_RATIO: u64 = 1032;

/// Decoded bytes after the last voxel that are looked at to reach the end of the stream and so its checksum.
const MAX_TRAILING_BYTES: u64 = 1 << 20;

/// How voxels are coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coding {
    Raw,
    /// RFC 1952.
    Gzip,
    /// RFC 1950.
    Zlib,
    /// Numbers in text.
    Ascii,
    /// Two hexadecimal digits per byte.
    Hex,
    Bzip2,
}

impl fmt::Display for Coding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Raw => "uncompressed",
            Self::Gzip => "gzip",
            Self::Zlib => "zlib",
            Self::Ascii => "text",
            Self::Hex => "hexadecimal",
            Self::Bzip2 => "bzip2",
        })
    }
}

/// What is known of the voxels before they are read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Payload {
    pub(super) grid: Grid,
    pub(super) element: Element,
    pub(super) endian: Endian,
    pub(super) coding: Coding,
    /// Bytes before the first voxel, counted after decompression.
    pub(super) skip: u64,
    /// Numbers of each voxel, of which one is kept.
    pub(super) components: Components,
}

impl Payload {
    /// Reads the voxels, from where `source` stands.
    pub(super) fn decode(&self, mut source: Source, options: &ReadOptions<'_>) -> Result<Decoded> {
        let what = format!(
            "{:?} voxels of {}",
            self.grid.size,
            self.components.of_type(self.element)
        );
        let bytes = self.bytes(self.grid.bytes);
        self.coding
            .check_length(&source, [self.skip_all(), bytes], self.element, &what)?;
        let path = source.path().to_path_buf();
        let mut skip = self.skip_all();
        if self.coding == Coding::Raw {
            source.advance(std::mem::take(&mut skip), "the header")?;
        }
        let reader = self.coding.decoder(source, self.element);
        self.decode_from(path, reader, skip, options)
    }

    /// Reads voxels that lie in several files. `to_data` goes to where those of one begin (see [`Parts::new`]).
    pub(super) fn decode_files(
        &self,
        header: &Path,
        files: Vec<PathBuf>,
        to_data: impl Fn(&mut Source, u64) -> Result<u64> + 'static,
        options: &ReadOptions<'_>,
    ) -> Result<Decoded> {
        let (coding, element) = (self.coding, self.element);
        let bytes = self.bytes(self.grid.all_bytes);
        let decoder = move |source| coding.decoder(source, element);
        let parts = Parts::new(header, files, bytes, (coding, element), to_data, decoder)?;
        let skip = self.bytes(self.grid.bytes_before);
        self.decode_from(header.to_path_buf(), Box::new(parts), skip, options)
    }

    fn decode_from(
        &self,
        path: PathBuf,
        reader: Box<dyn Read>,
        skip: u64,
        options: &ReadOptions<'_>,
    ) -> Result<Decoded> {
        let endian = match self.coding {
            Coding::Ascii if cfg!(target_endian = "big") => Endian::Big,
            Coding::Ascii => Endian::Little,
            _ => self.endian,
        };
        let mut stream = Stream {
            path,
            reader,
            swap: (endian == Endian::Big) != cfg!(target_endian = "big"),
            element: self.element,
            grid: self.grid,
            options,
        };
        stream.skip(skip)?;
        if self.components != Components::ONE {
            let all = std::mem::replace(&mut stream.reader, Box::new(io::empty()));
            let kept = ComponentReader::new(all, self.components, self.element, endian);
            stream.reader = Box::new(kept);
        }
        let decoded = if self.components.pick == Pick::Color {
            Decoded::Colors(stream.fill()?)
        } else {
            Decoded::Numbers(self.numbers(&mut stream)?)
        };
        if matches!(self.coding, Coding::Gzip | Coding::Zlib | Coding::Bzip2) {
            stream.reach_checksum()?;
        }
        Ok(decoded)
    }

    fn numbers(&self, stream: &mut Stream<'_>) -> Result<Voxels> {
        Ok(match self.element {
            Element::U8 => Voxels::U8(stream.fill()?),
            Element::I8 => Voxels::I8(stream.fill()?),
            Element::U16 => Voxels::U16(stream.fill()?),
            Element::I16 => Voxels::I16(stream.fill()?),
            Element::F32 => Voxels::F32(stream.fill()?),
            Element::F16 => stream.narrow::<half::f16>()?,
            Element::U32 => stream.narrow::<u32>()?,
            Element::I32 => stream.narrow::<i32>()?,
            Element::U64 => stream.narrow::<u64>()?,
            Element::I64 => stream.narrow::<i64>()?,
            Element::F64 => stream.narrow::<f64>()?,
        })
    }

    /// Bytes of all components, from those of one.
    pub(super) fn bytes(&self, of_one: u64) -> u64 {
        of_one.saturating_mul(self.components.count as u64)
    }

    /// Bytes before the first voxel that is wanted.
    fn skip_all(&self) -> u64 {
        let before = self.bytes(self.grid.bytes_before);
        self.skip.saturating_add(before)
    }
}

impl Coding {
    fn decoder(self, source: Source, element: Element) -> Box<dyn Read> {
        match self {
            Self::Raw => Box::new(source),
            Self::Gzip => Box::new(MultiGzDecoder::new(source)),
            Self::Zlib => Box::new(ZlibDecoder::new(source)),
            Self::Bzip2 => Box::new(MultiBzDecoder::new(source)),
            Self::Ascii => Box::new(AsciiDecoder::new(source, element)),
            Self::Hex => Box::new(HexDecoder::new(source)),
        }
    }

    /// Refuses, before anything is allocated, decoded data that the rest of the file cannot hold: bytes that are skipped
    /// and bytes of voxels.
    pub(super) fn check_length(
        self,
        source: &Source,
        [skip, voxels]: [u64; 2],
        element: Element,
        what: &str,
    ) -> Result<()> {
        let bytes = skip.saturating_add(voxels);
        let have = source.remaining();
        let least = match self {
            Self::Raw => bytes,
            Self::Gzip | Self::Zlib => bytes / MAX_DEFLATE_RATIO,
            Self::Bzip2 => bytes / MAX_BZIP2_RATIO,
            // A digit for each number, and what parts it from the next.
            Self::Ascii => (bytes / element.bytes())
                .saturating_mul(2)
                .saturating_sub(1),
            Self::Hex => bytes.saturating_mul(2),
        };
        if have >= least {
            return Ok(());
        }
        Err(source.bad(format!(
            "{what} are {voxels} bytes; as {self} data after {skip} bytes of header they take at least {least} bytes, \
             the file has {have}: it is cut short or its header is wrong"
        )))
    }
}

/// Decoded bytes on their way into an array.
struct Stream<'a> {
    path: PathBuf,
    reader: Box<dyn Read>,
    swap: bool,
    element: Element,
    grid: Grid,
    options: &'a ReadOptions<'a>,
}

impl Stream<'_> {
    /// The whole array, in the file's own type.
    fn fill<T: Stored>(&mut self) -> Result<Vec<T>> {
        let count = self.grid.voxels;
        let mut voxels = reserve(count)?;
        while voxels.len() < count {
            let start = voxels.len();
            voxels.resize(count.min(start + per_chunk::<T>()), T::zeroed());
            self.read_chunk(voxels.get_mut(start..).unwrap_or_default(), start)?;
        }
        Ok(voxels)
    }

    /// The whole array, in a smaller type that has every value.
    fn narrow<T: Wide>(&mut self) -> Result<Voxels> {
        let count = self.grid.voxels;
        let mut chunk = vec![T::zeroed(); per_chunk::<T>().min(count)];
        let mut narrowed = Narrowed::new(count)?;
        let mut start = 0;
        while start < count {
            chunk.truncate(count - start);
            self.read_chunk(&mut chunk, start)?;
            if let Some(at) = narrowed.extend(&chunk, count)? {
                return Err(not_exact(
                    &self.path,
                    start + at,
                    chunk.get(at),
                    self.element,
                ));
            }
            start += chunk.len();
        }
        Ok(narrowed.into_voxels())
    }

    /// Fills a piece of the array that begins at voxel `start`.
    fn read_chunk<T: Stored>(&mut self, chunk: &mut [T], start: usize) -> Result<()> {
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(chunk);
        let wanted = bytes.len();
        let got = read_full(&mut self.reader, bytes).map_err(|e| read_error(&self.path, e))?;
        if got < wanted {
            return Err(Error::volume(
                &self.path,
                format!(
                    "the data ends in voxel {} of {}: the file is cut short or its header is wrong",
                    start + got / size_of::<T>(),
                    self.grid.voxels
                ),
            ));
        }
        if self.swap {
            for value in chunk.iter_mut() {
                *value = value.swapped();
            }
        }
        if let Some(progress) = self.options.progress {
            let done = ((start + chunk.len()) * size_of::<T>()) as u64;
            progress(done.min(self.grid.bytes), self.grid.bytes);
        }
        Ok(())
    }

    fn skip(&mut self, bytes: u64) -> Result<()> {
        let skipped = io::copy(&mut self.reader.by_ref().take(bytes), &mut io::sink())
            .map_err(|e| read_error(&self.path, e))?;
        if skipped < bytes {
            return Err(Error::volume(
                &self.path,
                format!("the header skips {bytes} bytes, but the decoded data has only {skipped}"),
            ));
        }
        Ok(())
    }

    /// Decoders compare checksums at the end of their stream.
    fn reach_checksum(&mut self) -> Result<()> {
        io::copy(
            &mut self.reader.by_ref().take(MAX_TRAILING_BYTES),
            &mut io::sink(),
        )
        .map_err(|e| read_error(&self.path, e))?;
        Ok(())
    }
}

const fn per_chunk<T>() -> usize {
    CHUNK_BYTES / size_of::<T>()
}

/// Reads until the piece is full or the data ends.
pub(super) fn read_full(reader: &mut dyn Read, mut out: &mut [u8]) -> io::Result<usize> {
    let mut total = 0;
    while !out.is_empty() {
        match reader.read(out) {
            Ok(0) => break,
            Ok(got) => {
                total += got;
                out = out.get_mut(got..).unwrap_or_default();
            }
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(total)
}

/// An array of zeros. Its pages come from the system when they are first written, by whoever does it, and are not written here.
#[cfg(any(feature = "dicom", feature = "image-stacks"))]
pub(super) fn zeroed<T: bytemuck::Zeroable>(count: usize) -> Result<Vec<T>> {
    bytemuck::allocation::try_zeroed_vec(count)
        .map_err(|()| no_room::<T>(count, "the system gives no memory".into()))
}

/// An empty array with exactly the room that is needed.
pub(super) fn reserve<T>(count: usize) -> Result<Vec<T>> {
    let mut room = Vec::new();
    room.try_reserve_exact(count)
        .map_err(|e| no_room::<T>(count, e.to_string()))?;
    Ok(room)
}

fn no_room<T>(count: usize, detail: String) -> Error {
    Error::OutOfMemory {
        heap: "host",
        what: "voxels".into(),
        bytes: (count as u64).saturating_mul(size_of::<T>() as u64),
        detail,
    }
}
