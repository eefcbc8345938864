//! EXR files as other programs write them, made here by the crate `exr` or by changing bytes.

use super::*;
use crate::exr_header::parse;
use exr::image::write::layers::WritableLayers;
use exr::image::{Image, Levels, RipMaps};
use exr::math::RoundingMode;
use exr::meta::attribute::{AttributeValue, IntegerBounds, LineOrder};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Layer, Vec2,
    WritableImage, f16,
};
use std::fs;
use std::path::PathBuf;

const WIDTH: usize = 70;
const HEIGHT: usize = 37;

fn halves(count: usize) -> FlatSamples {
    FlatSamples::F16((0..count).map(|i| f16::from_f32((i % 4096) as f32 / 8.0 - 20.0)).collect())
}

fn floats(count: usize) -> FlatSamples {
    FlatSamples::F32((0..count).map(|i| 1e-3 * (i * i) as f32 - 1.0).collect())
}

fn integers(count: usize) -> FlatSamples {
    FlatSamples::U32((0..count as u32).map(|i| u32::MAX - 3 * i).collect())
}

/// A layer with a channel of each number type.
fn layer(encoding: Encoding) -> Layer<AnyChannels<FlatSamples>> {
    let count = WIDTH * HEIGHT;
    let list = [("far.Z", floats(count)), ("R", halves(count)), ("id", integers(count))];
    let channels = list.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
    Layer::new((WIDTH, HEIGHT), LayerAttributes::default(), encoding, AnyChannels::sort(channels))
}

fn encoding(compression: Compression, blocks: Blocks, line_order: LineOrder) -> Encoding {
    Encoding { compression, blocks, line_order }
}

struct Saved {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Saved {
    fn new(bytes: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        fs::write(&path, bytes).unwrap();
        Self { _folder: folder, path }
    }

    fn of<L>(image: &Image<L>) -> Self
    where
        for<'a> L: WritableLayers<'a>,
    {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        Self::new(&bytes.into_inner())
    }

    fn read(&self) -> ExrFile {
        read_exr_file(&self.path).unwrap()
    }

    fn error(&self) -> String {
        read_exr_file(&self.path).unwrap_err().to_string()
    }
}

fn values(part: &ExrPart, name: &str) -> Vec<f64> {
    part.channels[name].iter().collect()
}

fn expected(samples: FlatSamples) -> Vec<f64> {
    Samples::of(samples).iter().collect()
}

#[test]
fn every_lossless_compression_in_lines_and_tiles_gives_back_every_number() {
    let tiles = Blocks::Tiles(Vec2(16, 24));
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ] {
        for (blocks, order) in [
            (Blocks::ScanLines, LineOrder::Increasing),
            (Blocks::ScanLines, LineOrder::Decreasing),
            (tiles, LineOrder::Unspecified),
            (tiles, LineOrder::Decreasing),
        ] {
            let encoding = encoding(compression, blocks, order);
            let file = Saved::of(&Image::from_layer(layer(encoding))).read();
            let [part] = &file.parts[..] else { panic!("one part") };
            let kinds: Vec<(&str, &str)> = part
                .channels
                .iter()
                .map(|(name, samples)| (name.as_str(), samples.kind()))
                .collect();
            assert_eq!(kinds, [("R", "half"), ("far.Z", "float"), ("id", "uint")]);
            let count = WIDTH * HEIGHT;
            for (name, samples) in
                [("R", halves(count)), ("far.Z", floats(count)), ("id", integers(count))]
            {
                assert!(values(part, name) == expected(samples), "{encoding:?}: {name}");
            }
            let tiled = part.header.get("tiles").map(ExrAttribute::shown);
            assert_eq!(tiled.as_deref(), (blocks == tiles).then_some("16x24, one level"));
        }
    }
}

#[test]
fn of_several_resolutions_the_highest_is_read() {
    let sizes = (0..7).map(|level| [(WIDTH >> level).max(1), (HEIGHT >> level).max(1)]);
    let level_data: Vec<FlatSamples> =
        sizes.map(|[width, height]| floats(width * height)).collect();
    let rounding_mode = RoundingMode::Down;
    let mips = Levels::Mip { rounding_mode, level_data };
    let rips = Levels::Rip {
        rounding_mode,
        level_data: RipMaps {
            map_data: (0..6)
                .flat_map(|y| (0..7).map(move |x| [(WIDTH >> x).max(1), (HEIGHT >> y).max(1)]))
                .map(|[width, height]| floats(width * height))
                .collect(),
            level_count: Vec2(7, 6),
        },
    };
    for (levels, shown) in [(mips, "32x32, mip-maps"), (rips, "32x32, rip-maps")] {
        let tiles = Blocks::Tiles(Vec2(32, 32));
        let channel = AnyChannel::new("Z", levels);
        let layer = Layer::new(
            (WIDTH, HEIGHT),
            LayerAttributes::default(),
            encoding(Compression::ZIP16, tiles, LineOrder::Increasing),
            AnyChannels::sort([channel].into_iter().collect()),
        );
        let file = Saved::of(&Image::from_layer(layer)).read();
        assert!(values(&file.parts[0], "Z") == expected(floats(WIDTH * HEIGHT)), "{shown}");
        assert_eq!(file.parts[0].header.get("tiles").unwrap().shown(), shown);
    }
}

#[test]
fn parts_keep_their_names_windows_and_headers() {
    let part = |name: &str, position, size: (usize, usize), channel| {
        let attributes = LayerAttributes {
            layer_name: Some(name.into()),
            layer_position: position,
            owner: Some(format!("owner of {name}").as_str().into()),
            ..LayerAttributes::default()
        };
        let samples = floats(size.0 * size.1);
        let channels = AnyChannels::sort([AnyChannel::new(channel, samples)].into_iter().collect());
        Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels)
    };
    let display = IntegerBounds { position: Vec2(-2, 5), size: Vec2(40, 30) };
    let image = Image::from_layers(
        ImageAttributes::new(display),
        vec![part("beauty", Vec2(-2, 5), (40, 30), "R"), part("depth", Vec2(3, -4), (9, 7), "Z")],
    );
    let saved = Saved::of(&image);
    let file = saved.read();
    assert_eq!((file.display_origin, file.display_size), ([-2, 5], [40, 30]));
    let [beauty, depth] = &file.parts[..] else { panic!("two parts") };
    assert_eq!((beauty.name.as_deref(), depth.name.as_deref()), (Some("beauty"), Some("depth")));
    assert_eq!((depth.data_origin, depth.data_size), ([3, -4], [9, 7]));
    assert!(values(depth, "Z") == expected(floats(63)));
    assert_eq!(depth.header.text("owner").as_deref(), Some("owner of depth"));

    let first = read_exr(&saved.path).unwrap();
    assert_eq!(first.data_size, [40, 30]);
    assert_eq!(first.strings["owner"], "owner of beauty");
    assert_eq!(first.channels.len(), 1);
}

#[test]
fn attributes_are_shown_by_their_types() {
    let mut layer = layer(Encoding::UNCOMPRESSED);
    layer.attributes.world_to_camera = Some(std::array::from_fn(|i| i as f32 / 2.0));
    for (name, value) in [
        ("v", AttributeValue::FloatVec3((1.0, -2.5, 1e-7))),
        ("r", AttributeValue::Rational((24, 1))),
        ("n", AttributeValue::I32(-7)),
        ("d", AttributeValue::F64(0.1)),
        ("words", AttributeValue::TextVector(vec!["one".into(), "two".into()])),
        ("own", AttributeValue::Custom { kind: "mine".into(), bytes: vec![1, 2, 3].into() }),
    ] {
        layer.attributes.other.insert(name.into(), value);
    }
    let file = Saved::of(&Image::from_layer(layer)).read();
    let header = &file.parts[0].header;
    for (name, shown) in [
        ("v", "1.0 -2.5 1e-7"),
        ("r", "24/1"),
        ("n", "-7"),
        ("d", "0.1"),
        ("words", "one, two"),
        ("own", "3 bytes"),
        ("worldToCamera", "0.0 0.5 1.0 1.5 2.0 2.5 3.0 3.5 4.0 4.5 5.0 5.5 6.0 6.5 7.0 7.5"),
        ("compression", "none"),
        ("lineOrder", "increasing y"),
        ("dataWindow", "0 0 69 36"),
        ("channels", "R half, far.Z float, id uint"),
    ] {
        assert_eq!(header.get(name).unwrap().shown(), shown, "{name}");
    }
}

/// The file above with bytes changed where `found` stands, `offset` bytes behind its start.
fn changed(found: &[u8], offset: usize, new: &[u8]) -> Saved {
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer(Encoding::UNCOMPRESSED)).write().to_buffered(&mut bytes).unwrap();
    let mut bytes = bytes.into_inner();
    let at = bytes.windows(found.len()).position(|window| window == found).unwrap() + offset;
    bytes[at..at + new.len()].copy_from_slice(new);
    Saved::new(&bytes)
}

#[test]
fn what_is_not_read_is_an_error_that_says_so() {
    let compression = b"compression\0compression\0\x01\0\0\0";
    for (number, name) in [(10, "HTJ2K256"), (13, "ZSTD"), (77, "unknown")] {
        let message = changed(compression, compression.len(), &[number]).error();
        assert!(message.contains(&format!("compression {name} (number {number})")), "{message}");
        assert!(message.contains("save it with ZIP"), "{message}");
    }
    // Name, zero, type, linearity and padding; then the steps along x and y.
    let message = changed(b"far.Z\0\x02\0\0\0", 14, &[2, 0, 0, 0]).error();
    assert!(message.contains("channel 'far.Z' subsampled"), "{message}");

    let window = b"dataWindow\0box2i\0\x10\0\0\0";
    let huge = [0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 127, 36, 0, 0, 0];
    let message = changed(window, window.len(), &huge).error();
    assert!(message.contains("2147483648 x 37 pixels"), "{message}");

    let [flat, deep] = ["scanlineimage", "deepscanline"].map(|kind| {
        let length = (kind.len() as u32).to_le_bytes();
        [&b"type\0string\0"[..], &length, kind.as_bytes()].concat()
    });
    let mut bytes = fs::read(&changed(&flat, 0, &flat).path).unwrap();
    let at = bytes.windows(flat.len()).position(|window| window == flat).unwrap();
    bytes.splice(at..at + flat.len(), deep);
    let message = Saved::new(&bytes).error();
    assert!(message.contains("deep"), "{message}");
}

#[test]
fn headers_that_end_early_are_no_headers() {
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer(Encoding::UNCOMPRESSED)).write().to_buffered(&mut bytes).unwrap();
    let bytes = bytes.into_inner();
    let length = (1..bytes.len()).find(|&end| parse(&bytes[..end]).is_ok()).unwrap();
    assert!((200..2000).contains(&length), "{length} bytes");
    assert!(parse(&bytes[..length - 1]).is_err());
    assert!(Saved::new(&bytes[..length - 1]).error().contains("ends within its header"));
    assert!(Saved::new(&bytes[..length]).error().contains("cut off"));
    assert!(Saved::new(b"P6 1 1").error().contains("does not begin as one"));
    // A length that points far behind the file.
    let at = bytes.windows(5).position(|window| window == b"box2i").unwrap() + 6;
    let mut wrong = bytes.clone();
    wrong[at..at + 4].copy_from_slice(&[255; 4]);
    assert!(Saved::new(&wrong).error().contains("ends within its header"));
}

#[test]
fn bytes_that_the_pixels_take_are_known_from_the_header() {
    let saved = Saved::of(&Image::from_layer(layer(Encoding::SMALL_LOSSLESS)));
    assert_eq!(exr_pixel_bytes(&saved.path).unwrap(), (WIDTH * HEIGHT * (2 + 4 + 4)) as u64);
}
