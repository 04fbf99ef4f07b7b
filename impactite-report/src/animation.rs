//! Animated PNG files from PNG files of equal size.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use png::{BitDepth, BlendOp, ColorType, Compression, Decoder, DisposeOp, Encoder, Transformations};

use impactite_simd::Team;

use crate::error::ReportError;

/// Maximum number of frames: of longer series, frames at equal intervals are selected.
pub const MOST_FRAMES: usize = 60;
/// Maximum width, pixels: wider frames are downsampled by averaging squares of pixels.
pub const WIDEST: usize = 640;
/// Delay of a frame, s / 1000; [`LAST_DELAY`] applies to the last one.
pub const DELAY: u16 = 100;
/// Delay of the last frame before the animation restarts, s / 1000.
pub const LAST_DELAY: u16 = 1500;

/// Number of frames that are read at a time, on all threads.
const READ_TOGETHER: usize = 8;

/// Picture with three bytes per pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Pixels {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

/// Bytes per pixel.
const RGB: usize = 3;

/// Select frames of `count`: the first, the last, and others at equal intervals, at most [`MOST_FRAMES`].
#[must_use]
pub fn taken(count: usize) -> Vec<usize> {
    match count {
        0..=MOST_FRAMES => (0..count).collect(),
        _ => (0..MOST_FRAMES).map(|n| n * (count - 1) / (MOST_FRAMES - 1)).collect(),
    }
}

/// Build an endless animated PNG from these PNG files, in order: at most [`MOST_FRAMES`] frames ([`taken`]) and
/// [`WIDEST`] pixels in width. The same files give the same bytes.
///
/// # Errors
/// No files; a file that cannot be read, is no PNG, or has another size than the first.
pub fn animated_png<P: AsRef<Path>>(files: &[P]) -> Result<Vec<u8>, ReportError> {
    let paths: Vec<&Path> = taken(files.len()).into_iter().map(|n| files[n].as_ref()).collect();
    let mut frames = paths.chunks(READ_TOGETHER).flat_map(read_all);
    let (Some(first), Some(frame)) = (paths.first(), frames.next()) else {
        return Err(ReportError::Field { field: "frames", value: "0".into(), allowed: "at least 1" });
    };
    let ([width, height], mut before) = frame?;

    let failed = |error| ReportError::damaged(first, format!("no animation: {error}"));
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, before.width as u32, before.height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_animated(paths.len() as u32, 0).map_err(failed)?;
    encoder.set_blend_op(BlendOp::Source).map_err(failed)?;
    encoder.set_dispose_op(DisposeOp::None).map_err(failed)?;
    let mut writer = encoder.write_header().map_err(failed)?;
    let delay = |n: usize| if n + 1 == paths.len() { LAST_DELAY } else { DELAY };
    writer.set_frame_delay(delay(0), 1000).map_err(failed)?;
    writer.write_image_data(&before.bytes).map_err(failed)?;
    for ((n, path), frame) in paths.iter().enumerate().skip(1).zip(frames) {
        let ([own_width, own_height], frame) = frame?;
        if [own_width, own_height] != [width, height] {
            let why = format!(
                "it has {own_width} x {own_height} pixels, and the frames before it {width} x {height}"
            );
            return Err(ReportError::damaged(path, why));
        }
        let [left, top, right, bottom] = frame.changed_from(&before);
        // The encoder checks a size against the position of the previous frame.
        writer.set_frame_position(0, 0).map_err(failed)?;
        writer.set_frame_dimension((right - left) as u32, (bottom - top) as u32).map_err(failed)?;
        writer.set_frame_position(left as u32, top as u32).map_err(failed)?;
        writer.set_frame_delay(delay(n), 1000).map_err(failed)?;
        writer.write_image_data(&frame.cut([left, top, right, bottom])).map_err(failed)?;
        before = frame;
    }
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

/// Read these PNG files on the threads of the team: width and height of each, and its downsampled pixels.
fn read_all(paths: &[&Path]) -> Vec<Result<([usize; 2], Pixels), ReportError>> {
    let read_one = |path: &Path| {
        let pixels = read(path)?;
        let (size, over) = ([pixels.width, pixels.height], pixels.width.div_ceil(WIDEST));
        Ok((size, pixels.averaged(over)))
    };
    let mut frames: Vec<_> = paths.iter().map(|path| (*path, None)).collect();
    Team::ambient().each(&mut frames, |_, (path, frame)| *frame = Some(read_one(path)));
    frames.into_iter().filter_map(|(_, frame)| frame).collect()
}

/// Read a PNG file as three bytes per pixel, blended over white.
fn read(path: &Path) -> Result<Pixels, ReportError> {
    let file = File::open(path).map_err(ReportError::read(path))?;
    let mut decoder = Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::normalize_to_color8());
    let damaged = |error: png::DecodingError| ReportError::damaged(path, format!("no PNG picture: {error}"));
    let mut reader = decoder.read_info().map_err(damaged)?;
    let size = reader.output_buffer_size();
    let size = size.ok_or_else(|| ReportError::damaged(path, "it is too large"))?;
    let mut bytes = vec![0; size];
    let info = reader.next_frame(&mut bytes).map_err(damaged)?;
    bytes.truncate(info.buffer_size());
    let on_white = |c: u8, alpha: u8| {
        let (c, alpha) = (u32::from(c), u32::from(alpha));
        ((c * alpha + 255 * (255 - alpha) + 127) / 255) as u8
    };
    let bytes = match info.color_type {
        ColorType::Rgb => bytes,
        ColorType::Rgba => {
            bytes.chunks_exact(4).flat_map(|p| [0, 1, 2].map(|c| on_white(p[c], p[3]))).collect()
        }
        ColorType::GrayscaleAlpha => {
            bytes.chunks_exact(2).flat_map(|p| [on_white(p[0], p[1]); RGB]).collect()
        }
        // Palettes are already expanded to colours.
        ColorType::Grayscale | ColorType::Indexed => bytes.iter().flat_map(|&c| [c; RGB]).collect(),
    };
    Ok(Pixels { width: info.width as usize, height: info.height as usize, bytes })
}

impl Pixels {
    /// Downsample squares of `n` by `n` pixels to their mean; incomplete squares at the right and lower edge use their existing pixels.
    fn averaged(self, n: usize) -> Pixels {
        if n <= 1 {
            return self;
        }
        let (width, height) = (self.width.div_ceil(n), self.height.div_ceil(n));
        let mut bytes = Vec::with_capacity(RGB * width * height);
        let mut sums = vec![[0_u32; RGB]; width];
        for rows in self.bytes.chunks(RGB * self.width * n) {
            sums.fill([0; RGB]);
            for row in rows.chunks_exact(RGB * self.width) {
                for (sum, square) in sums.iter_mut().zip(row.chunks(RGB * n)) {
                    for pixel in square.chunks_exact(RGB) {
                        (0..RGB).for_each(|c| sum[c] += u32::from(pixel[c]));
                    }
                }
            }
            for (x, sum) in sums.iter().enumerate() {
                let columns = n.min(self.width - n * x);
                let count = (columns * (rows.len() / (RGB * self.width))) as u32;
                bytes.extend(sum.map(|sum| ((sum + count / 2) / count) as u8));
            }
        }
        Pixels { width, height, bytes }
    }

    /// Bounding box (left, top, right, bottom) of the differences from a picture of the same size; at least one pixel.
    fn changed_from(&self, other: &Pixels) -> [usize; 4] {
        let [mut left, mut top, mut right, mut bottom] = [self.width, self.height, 0, 0];
        let pixels = self.bytes.chunks_exact(RGB).zip(other.bytes.chunks_exact(RGB));
        for (n, _) in pixels.enumerate().filter(|(_, (a, b))| a != b) {
            let (x, y) = (n % self.width, n / self.width);
            (left, right) = (left.min(x), right.max(x + 1));
            (top, bottom) = (top.min(y), bottom.max(y + 1));
        }
        if right == 0 { [0, 0, 1, 1] } else { [left, top, right, bottom] }
    }

    /// Return the bytes within left, top, right, bottom.
    fn cut(&self, [left, top, right, bottom]: [usize; 4]) -> Vec<u8> {
        let row = |y: usize| &self.bytes[(y * self.width + left) * RGB..(y * self.width + right) * RGB];
        (top..bottom).flat_map(row).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn save(folder: &Path, name: &str, pixels: &Pixels) -> PathBuf {
        let path = folder.join(name);
        let file = File::create(&path).expect("a file");
        let mut encoder = Encoder::new(file, pixels.width as u32, pixels.height as u32);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(&pixels.bytes).expect("pixels");
        path
    }

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("impactite-report-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        folder
    }

    /// Square that moves over a background of many colours.
    fn frame(width: usize, height: usize, at: usize) -> Pixels {
        let colour = |n: usize| {
            let (x, y) = (n % width, n / width);
            let within = (at..at + 5).contains(&x) && (3..7).contains(&y);
            if within { [250, 20, at as u8] } else { [x as u8, y as u8, (x * y) as u8] }
        };
        Pixels { width, height, bytes: (0..width * height).flat_map(colour).collect() }
    }

    /// Frames as shown by a viewer, with their delays, s / 1000.
    fn shown(bytes: &[u8]) -> Vec<(Pixels, u16)> {
        let mut reader = Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        let (width, height) = (reader.info().width as usize, reader.info().height as usize);
        let count = reader.info().animation_control().expect("an animation").num_frames;
        let mut canvas = Pixels { width, height, bytes: vec![0; RGB * width * height] };
        let mut list = Vec::new();
        for _ in 0..count {
            let mut part = vec![0; reader.output_buffer_size().expect("a size")];
            let info = reader.next_frame(&mut part).expect("a frame");
            let control = *reader.info().frame_control().expect("a frame of an animation");
            let (w, left, top) = (info.width as usize, control.x_offset as usize, control.y_offset as usize);
            for y in 0..info.height as usize {
                let at = ((top + y) * width + left) * RGB;
                canvas.bytes[at..at + w * RGB].copy_from_slice(&part[y * w * RGB..(y + 1) * w * RGB]);
            }
            assert_eq!(control.delay_den, 1000);
            list.push((canvas.clone(), control.delay_num));
        }
        list
    }

    #[test]
    fn it_decodes_to_the_frames_that_it_was_made_from() {
        let folder = folder("frames");
        // The third frame equals the second: nothing changes.
        let frames = [2, 9, 9, 20, 0].map(|at| frame(40, 30, at));
        let files: Vec<PathBuf> =
            frames.iter().enumerate().map(|(n, f)| save(&folder, &format!("{n}.png"), f)).collect();
        let bytes = animated_png(&files).expect("an animation");
        let shown = shown(&bytes);
        assert_eq!(shown.iter().map(|(p, _)| p).collect::<Vec<_>>(), frames.iter().collect::<Vec<_>>());
        assert_eq!(
            shown.iter().map(|(_, d)| *d).collect::<Vec<_>>(),
            [DELAY, DELAY, DELAY, DELAY, LAST_DELAY]
        );
        assert_eq!(animated_png(&files).expect("again"), bytes);

        let other = save(&folder, "other.png", &frame(41, 30, 0));
        let error = animated_png(&[files[0].clone(), other]).expect_err("another size").to_string();
        assert!(error.contains("other.png") && error.contains("41 x 30 pixels"), "{error}");
        let text = folder.join("text.png");
        std::fs::write(&text, "no picture").expect("written");
        let error = animated_png(&[text]).expect_err("no PNG").to_string();
        assert!(error.contains("text.png") && error.contains("no PNG picture"), "{error}");
        assert!(animated_png::<PathBuf>(&[]).is_err());
        std::fs::remove_dir_all(&folder).expect("removed");
    }

    #[test]
    fn patches_of_any_place_and_size_are_shown() {
        let folder = folder("patches");
        let (width, height) = (40, 30);
        // Left, top, right, bottom: a small patch at the right, a wide one, the whole picture, then arbitrary ones.
        let mut patches = vec![
            [36, 25, 39, 29],
            [0, 10, 40, 12],
            [0, 0, 40, 30],
            [39, 29, 40, 30],
            [0, 0, 1, 30],
            [0, 0, 1, 1],
        ];
        let mut seed = 7_u64;
        let mut below = |n: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize % n
        };
        for _ in 0..MOST_FRAMES - 7 {
            let (left, top) = (below(width), below(height));
            patches.push([left, top, left + 1 + below(width - left), top + 1 + below(height - top)]);
        }
        let mut frames = vec![frame(width, height, 3)];
        for (n, [left, top, right, bottom]) in patches.into_iter().enumerate() {
            let mut next = frames[n].clone();
            for y in top..bottom {
                for byte in &mut next.bytes[(y * width + left) * RGB..(y * width + right) * RGB] {
                    *byte = byte.wrapping_add(1 + n as u8);
                }
            }
            frames.push(next);
        }
        let files: Vec<PathBuf> =
            frames.iter().enumerate().map(|(n, f)| save(&folder, &format!("{n}.png"), f)).collect();
        let shown = shown(&animated_png(&files).expect("an animation"));
        assert_eq!(shown.into_iter().map(|(pixels, _)| pixels).collect::<Vec<_>>(), frames);
        std::fs::remove_dir_all(&folder).expect("removed");
    }

    #[test]
    fn it_is_bounded() {
        assert_eq!(taken(3), [0, 1, 2]);
        let some = taken(1000);
        assert_eq!((some.len(), some[0], some[MOST_FRAMES - 1]), (MOST_FRAMES, 0, 999));
        assert!(some.windows(2).all(|w| (16..=17).contains(&(w[1] - w[0]))));

        let folder = folder("wide");
        let wide = frame(1300, 11, 4);
        let shown = shown(&animated_png(&[save(&folder, "wide.png", &wide)]).expect("an animation"));
        assert_eq!((shown[0].0.width, shown[0].0.height), (434, 4));
        // Three by three pixels are averaged; at the corner one by two remain.
        let mean = |xs: &[usize], ys: &[usize], c: usize| {
            let all = ys.iter().flat_map(|y| xs.iter().map(move |x| (y * 1300 + x) * RGB + c));
            let count = (xs.len() * ys.len()) as f64;
            (all.map(|at| f64::from(wide.bytes[at])).sum::<f64>() / count).round() as u8
        };
        for c in 0..RGB {
            assert_eq!(shown[0].0.bytes[c], mean(&[0, 1, 2], &[0, 1, 2], c));
            assert_eq!(shown[0].0.bytes[(3 * 434 + 433) * RGB + c], mean(&[1299], &[9, 10], c));
        }
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
