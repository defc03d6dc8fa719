//! What is done to formats of cameras, and to documents.

use crate::damage::{Damage, add_missing_options};
use crate::mat_writer::{CAMERA, Out, frame, mat, sequence};
use touchline_documents::exchange::Format;

pub fn add(damage: &mut Damage) {
    match damage.sample.format {
        Format::Json => document(damage),
        Format::SoccerNet | Format::PnlCalib => soccernet(damage),
        Format::Csv => csv(damage),
        Format::Wc14 => wc14(damage),
        Format::TsWorldCup => tsworldcup(damage),
        Format::Homography => homography(damage),
        Format::Homographies => homographies(damage),
        Format::BroadTrack => broadtrack(damage),
        Format::Colmap => colmap(damage),
        Format::OpenCv => opencv(damage),
        Format::OpenTrackIo => opentrackio(damage),
        Format::Fifa => fifa(damage),
        Format::Lens => lens(damage),
        Format::FreeD => freed(damage),
        Format::FreeDCsv => freed_csv(damage),
        Format::DeepSport => deepsport(damage),
        Format::Chan => chan(damage),
        Format::AuthorsMat => authors_mat(damage),
        _ => {}
    }
}

fn document(damage: &mut Damage) {
    damage.swap("newer-version", "\"version\": 1", "\"version\": 999");
    damage.swap(
        "other-format",
        "\"format\": \"touchline\"",
        "\"format\": \"other\"",
    );
    damage.swap("unknown-status", "\"reference\"", "\"perfect\"");
    damage.swap("click-at-null", "444.5", "null");
    damage.swap("no-cameras", "\"cameras\": [", "\"lenses\": [");
    damage.swap(
        "deep-unknown-key",
        "\"version\": 1",
        &format!(
            "\"version\": 1, \"x\": {}1{}",
            "[".repeat(110),
            "]".repeat(110)
        ),
    );
}

fn soccernet(damage: &mut Damage) {
    damage.swap("no-pan", "pan_degrees", "yaw_degrees");
    damage.swap(
        "steep-in-words",
        "\"tilt_degrees\":",
        "\"tilt_degrees\": \"steep\", \"was\":",
    );
    damage.swap(
        "no-focal-length",
        "\"x_focal_length\":",
        "\"x_focal_length\": 0, \"was\":",
    );
    damage.swap(
        "oblong-pixels",
        "\"y_focal_length\":",
        "\"y_focal_length\": 230, \"was\":",
    );
    damage.swap(
        "a-place-of-two",
        "\"position_meters\":",
        "\"position_meters\": [1, 2], \"was\":",
    );
    damage.swap(
        "a-place-of-millions",
        "\"position_meters\":",
        "\"position_meters\": [6000000, 0, 0], \"was\":",
    );
    let many = format!("\"position_meters\": [{}0], \"was\":", "0,".repeat(100_000));
    damage.swap("a-place-of-100000-numbers", "\"position_meters\":", &many);
    damage.swap(
        "third-radial-term",
        "\"radial_distortion\":",
        "\"radial_distortion\": [0.1,0,0.3,0,0,0], \"was\":",
    );
    damage.swap(
        "tangential",
        "\"tangential_distortion\":",
        "\"tangential_distortion\": [0.1,0], \"was\":",
    );
}

fn csv(damage: &mut Damage) {
    damage.bytes("another-table", "a,b\n1,2\n");
    damage.bytes("a-million-columns", ",".repeat(1_000_000));
    damage.swap("leaves-the-folder", "images/0001.jpg", "../../etc/passwd");
    damage.swap("a-frame-twice", "images/0002.jpg", "images/0001.jpg");
    damage.swap("width-zero", ",1920,", ",0,");
    damage.swap("width-in-words", ",1920,", ",wide,");
    damage.swap("focal-length-below-zero", ",2410,", ",-2410,");
    damage.swap("nan", ",2410,", ",NaN,");
    damage.swap("infinite", ",960,", ",inf,");
    damage.swap("nothing", ",2410,", ",,");
    damage.swap("a-column-twice", "r11", "r12");
    damage.swap("half-a-frame", "\n412,", "\n412.5,");
    damage.swap("a-frame-beyond-all", "\n412,", "\n1e300,");
    damage.swap("an-open-quote", "\n412,", "\n\"412,");
    damage.swap("a-field-more", "\n412,", "\n1,412,");
}

fn wc14(damage: &mut Damage) {
    let file = "other.homographyMatrix";
    damage.beside("six-numbers", file, "1 2 3\n4 5 6\n");
    damage.beside("ten-numbers", file, "1 2 3\n4 5 6\n7 8 9 10\n");
    damage.beside("a-word", file, "1 2 3\n4 5 6\n7 8 nine\n");
    damage.beside("nan", file, "1 2 3\n4 5 6\n7 8 nan\n");
    damage.beside("zero", file, "0 0 0\n0 0 0\n0 0 0\n");
    damage.beside("singular", file, "1 2 3\n2 4 6\n0 0 1\n");
    damage.beside(
        "nearly-singular",
        file,
        "1 2 3\n2 4 6.0000000000000001\n0 0 1e-300\n",
    );
    damage.beside("no-camera", file, "1 0 0\n0 1 0\n0 0 1\n");
    damage.beside("enormous", file, "1e300 0 0\n0 1e300 0\n0 0 1\n");
    damage.beside("a-million-numbers", file, "1 ".repeat(1_000_000));
    damage.beside(
        "a-frame-twice",
        "again/0001.homographyMatrix",
        damage.sample.text(),
    );
}

fn tsworldcup(damage: &mut Damage) {
    let good = damage.sample.bytes(damage.sample.main()).to_vec();
    let swapped = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let at = good
            .windows(from.len())
            .position(|window| window == from.as_bytes())
            .unwrap();
        let mut bytes = good.clone();
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        bytes
    };
    let with = |at: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        bytes
    };
    damage.bytes("magic-only", good[..6].to_vec());
    damage.bytes("header-only", good[..128].to_vec());
    damage.bytes("a-byte-less", good[..good.len() - 1].to_vec());
    damage.bytes("version-nine", with(6, &[9]));
    damage.bytes(
        "a-header-of-gigabytes",
        with(6, &[2, 0, 0xff, 0xff, 0xff, 0xff]),
    );
    damage.bytes("objects", swapped("'<f8'", "'|O' "));
    damage.bytes("integers", swapped("<f8", "<i8"));
    damage.bytes("other-byte-order", swapped("<f8", ">f8"));
    damage.bytes("other-shape", swapped("(3, 3)", "(2, 3)"));
    damage.bytes("huge-shape", swapped("(3, 3), }", "(999999,)"));
    damage.bytes("nan", with(128, &f64::NAN.to_le_bytes()));
    damage.bytes("singular", with(128, &[0; 72]));
    damage.bytes("infinite", with(128, &f64::INFINITY.to_le_bytes()));
}

fn homographies(damage: &mut Damage) {
    damage.bytes("another-table", "a,b\n1,2\n");
    damage.bytes("no-columns", "\n");
    damage.swap("another-column", "homography", "colour");
    damage.swap("eight-numbers", "\"[[-0.2852303786, ", "\"[[");
    damage.swap(
        "ten-numbers",
        "\"[[-0.2852303786, ",
        "\"[[1, -0.2852303786, ",
    );
    damage.swap("a-word", "-0.2852303786", "minus");
    damage.swap("nan", "-0.2852303786", "NaN");
    damage.swap("infinite", "-0.2852303786", "inf");
    damage.swap("singular", "[0, -0.01592175417, 1]", "[0, 0, 0]");
    damage.swap("no-matrix", "0001.jpg,\"", "0001.jpg,\"\"\n0003.jpg,\"");
    damage.swap("a-frame-twice", "0002.jpg", "0001.jpg");
    damage.swap("leaves-the-folder", "0001.jpg", "../0001.jpg");
    damage.swap("an-open-quote", "]]\"", "]]");
    damage.swap("a-field-more", "0001.jpg,", "0001.jpg,1,");
    damage.swap("a-column-twice", "homography", "image");
    damage.options("no-plane", |options| {
        options.homographies.plan = None;
    });
    damage.options("no-direction", |options| {
        options.homographies.direction = None;
    });
}

fn homography(damage: &mut Damage) {
    damage.swap("no-direction", "\"direction\"", "\"way\"");
    damage.swap("both-directions", "\"pitch_from_image\"", "\"both\"");
    damage.swap("feet", "\"unit\":\"m\"", "\"unit\":\"ft\"");
    damage.swap("no-unit", "\"unit\":\"m\"", "\"unit\":null");
    damage.swap("pixels-in-the-middle", "\"corner\"", "\"middle\"");
    damage.swap("two-rows", "\"h\":[", "\"h\":[[1,0,0],[0,1,0]],\"was\":[");
    damage.swap(
        "rows-of-two",
        "\"h\":[",
        "\"h\":[[1,0],[0,1],[0,0]],\"was\":[",
    );
    damage.swap(
        "singular",
        "\"h\":[",
        "\"h\":[[0,0,0],[0,0,0],[0,0,0]],\"was\":[",
    );
    damage.swap(
        "no-camera",
        "\"h\":[",
        "\"h\":[[1,0,0],[0,1,0],[0,0,1]],\"was\":[",
    );
    damage.swap("leaves-the-folder", "images/0001.jpg", "../0001.jpg");
    damage.swap("a-frame-twice", "images/0002.jpg", "images/0001.jpg");
    damage.swap("a-size-of-one", "[1920,1080]", "[1920]");
    damage.swap("half-a-pixel", "[1920,1080]", "[1920.5,1080]");
}

fn broadtrack(damage: &mut Damage) {
    damage.bytes("no-frames", "{}");
    damage.swap("a-frame-twice", "\"0002.jpg\"", "\"0001.jpg\"");
    damage.swap("leaves-the-folder", "0001.jpg", "../0001.jpg");
    damage.swap("no-score", "\"score\"", "\"scores\"");
    damage.swap("no-camera", "\"cp\"", "\"camera\"");
    damage.swap("half-a-pixel", "1920.0", "1920.5");
    damage.swap("wider-than-half-a-turn", "43.43", "243.43");
    damage.swap("narrower-than-nothing", "43.43", "-43.43");
    damage.swap("far-in-words", "60.0", "\"far\"");
    damage.swap(
        "three-terms",
        "\"normalizedRadialDistortionCoefficients\": [",
        "\"normalizedRadialDistortionCoefficients\": [1, 2, 3, ",
    );
}

fn colmap(damage: &mut Damage) {
    damage.without("no-cameras", "cameras.txt");
    damage.without("no-images", "images.txt");
    damage.swap_in("cameras.txt", "fisheye", "RADIAL", "FISHEYE");
    damage.swap_in("cameras.txt", "a-parameter-less", " 0.0661 0", " 0.0661");
    damage.swap_in("cameras.txt", "width-below-zero", "1920", "-1920");
    damage.swap_in("cameras.txt", "width-of-millions", "1920", "19200000");
    damage.swap_in("cameras.txt", "nan", "2410", "nan");
    damage.swap_in("cameras.txt", "a-camera-twice", "\n2 RADIAL", "\n1 RADIAL");
    let lines: Vec<String> = damage
        .sample
        .text()
        .lines()
        .map(ToOwned::to_owned)
        .collect();
    let without_last = format!("{}\n", lines[..lines.len() - 1].join("\n"));
    damage.bytes("the-last-line-missing", without_last);
    damage.swap("points-by-four", "444.5 ", "444.5 1 ");
    let only_images: Vec<&str> = lines
        .iter()
        .map(String::as_str)
        .filter(|line| line.contains(".jpg"))
        .collect();
    damage.bytes("a-line-an-image", only_images.join("\n"));
    damage.swap("unknown-camera", " 1 images", " 7 images");
    damage.swap("leaves-the-folder", "images/0001", "../0001");
    damage.swap("a-frame-twice", "images/0002", "images/0001");
    damage.swap("a-long-quaternion", "\n1 0.", "\n1 5.");
    damage.swap("a-field-less", "\n1 0.", "\n0.");
}

fn opencv(damage: &mut Damage) {
    damage.swap("no-rotation", "rvec", "om");
    damage.swap("a-key-twice", "tvec", "rvec");
    damage.swap("width-zero", "image_width: 1920", "image_width: 0");
    damage.swap("width-in-words", "image_width: 1920", "image_width: wide");
    damage.swap("oblong-pixels", "959.5, 0.0, 2410.0", "959.5, 0.0, 230.0");
    damage.swap("a-number-less", "959.5, ", "");
    damage.swap("yaml-nan", "959.5", ".nan");
    damage.swap("nan", "959.5", "nan");
    damage.swap("third-term", "0.0661, 0.0, 0.0", "0.0661, 0.0, 0.2");
    damage.swap("an-alias", "data: [ 2410.0", "data: *x [ 2410.0");
    damage.swap(
        "an-object-tag",
        "image_width: 1920",
        "image_width: !!python/object/apply:os.system [ls]",
    );
    damage.swap("a-place-of-millions", "tvec: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ ", "tvec: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 1e9, 0, 0 ]\nwas: !!opencv-matrix\n   data: [ ");
}

fn opentrackio(damage: &mut Damage) {
    damage.bytes("nothing", "{}");
    damage.swap("no-lens", "\"lens\"", "\"lense\"");
    damage.swap("no-transforms", "\"transforms\"", "\"transform\"");
    damage.swap(
        "empty-transforms",
        "\"transforms\":[",
        "\"transforms\":[],\"was\":[",
    );
    damage.swap("no-pan", "\"pan\"", "\"yaw\"");
    damage.swap("a-flat-scale", "\"id\":\"Camera\"", "\"scale\":{\"x\":0}");
    damage.swap(
        "a-scale-that-shears",
        "\"transforms\":[",
        "\"transforms\":[{\"translation\":{\"x\":0,\"y\":0,\"z\":0},\
         \"rotation\":{\"pan\":0,\"tilt\":0,\"roll\":0},\"scale\":{\"x\":2}},",
    );
    damage.swap("another-lens", "Brown-Conrady U-D", "Fisheye");
    damage.swap("a-second-term", ",0.0,0.0,0.0]}", ",0.5,0.0,0.0]}");
    damage.swap(
        "no-focal-length",
        "\"pinholeFocalLength\":",
        "\"pinholeFocalLength\":0,\"was\":",
    );
    damage.swap(
        "focal-length-in-words",
        "\"pinholeFocalLength\":",
        "\"pinholeFocalLength\":\"long\",\"was\":",
    );
    damage.swap("width-zero", "{\"width\":1920", "{\"width\":0");
    damage.swap("a-sensor-of-nothing", "{\"width\":9.6", "{\"width\":0");
    damage.swap(
        "a-sensor-too-small-for-numbers",
        "{\"width\":9.6",
        "{\"width\":1e-320",
    );
    damage.swap("a-frame-twice", "; 0002", "; 0001");
}

fn lens(damage: &mut Damage) {
    damage.options("no-size", |options| options.size = None);
    damage.options("no-sensor", |options| options.sensor_width_mm = None);
    for (name, value) in [
        ("a-word", "wide"),
        ("zero", "0"),
        ("divided-by-zero", "32/0"),
        ("unknown", "65535/65535"),
        ("no-number", "NaN"),
        ("endless", "1e999"),
    ] {
        damage.swap(name, "19,A001,32", &format!("19,A001,{value}"));
    }
    damage.swap("another-column", "Focal Length (mm)", "Focus Distance (ft)");
    damage.swap("a-field-too-few", ",32.5", "");
}

fn fifa(damage: &mut Damage) {
    let good = damage.sample.bytes(damage.sample.main()).to_vec();
    let with = |at: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        bytes
    };
    // The table at the end begins with the entry of K; the last 22 bytes say where.
    let end = good.len() - 22;
    let table = good
        .windows(4)
        .position(|window| window == b"PK\x01\x02")
        .unwrap();
    let name = good
        .windows(5)
        .position(|window| window == b"K.npy")
        .unwrap();
    damage.bytes("half-of-it", good[..good.len() / 2].to_vec());
    damage.bytes("without-its-table", good[..table].to_vec());
    damage.bytes("without-its-end", good[..end].to_vec());
    damage.bytes("a-table-beyond-the-end", with(end + 16, &[0xff; 4]));
    damage.bytes("65535-arrays", with(end + 10, &[0xff; 2]));
    damage.bytes("no-arrays", with(end + 10, &[0, 0]));
    damage.bytes("an-array-of-gigabytes", with(table + 24, &[0xff; 4]));
    damage.bytes("packed-gigabytes", with(table + 20, &[0xff; 4]));
    damage.bytes("packed-by-another-method", with(table + 10, &[12, 0]));
    damage.bytes("encrypted", with(table + 8, &[1, 0]));
    damage.bytes("a-wrong-check-sum", with(table + 16, &[0; 4]));
    damage.bytes("an-array-beyond-the-end", with(table + 42, &[0xff; 4]));
    damage.bytes("no-k", with(table + 46, b"L.npy"));
    damage.bytes("other-numbers", with(name + 5 + 128, &[0xff; 8]));
    damage.bytes("a-plain-array", good[name + 5..].to_vec());
}

/// A packet whose checksum is right whatever was done to it.
fn with_checksum(mut packet: Vec<u8>) -> Vec<u8> {
    packet[28] = packet[..28]
        .iter()
        .fold(0x40_u8, |sum, byte| sum.wrapping_sub(*byte));
    packet
}

fn freed(damage: &mut Damage) {
    let good = damage.sample.bytes(damage.sample.main()).to_vec();
    let first = good[..29].to_vec();
    let with = |at: usize, new: &[u8]| {
        let mut packet = first.clone();
        packet[at..at + new.len()].copy_from_slice(new);
        packet
    };
    damage.bytes("one-byte", vec![0xd1]);
    damage.bytes("another-type", with(0, &[0xd0]));
    damage.bytes("wrong-checksum", with(28, &[0]));
    damage.bytes("two-bytes-left", [first.clone(), vec![1, 2]].concat());
    damage.bytes("shifted-by-one", [vec![0], good.clone()].concat());
    damage.bytes("zoom-zero", with_checksum(with(20, &[0, 0, 0])));
    damage.bytes("text", "pan 12.5 tilt -11.2\n".repeat(29));
    damage.bytes(
        "the-second-damaged",
        [first.clone(), with(5, &[0xff])].concat(),
    );
    add_missing_options(damage);
}

fn freed_csv(damage: &mut Damage) {
    damage.bytes("another-table", "a,b\n1,2\n");
    let with = |column: usize, value: &str| {
        let text = damage.sample.text();
        let mut lines: Vec<String> = text.lines().map(ToOwned::to_owned).collect();
        let mut fields: Vec<&str> = lines[1].split(',').collect();
        fields[column] = value;
        lines[1] = fields.join(",");
        lines.join("\n")
    };
    let tables = [
        ("nan", with(4, "nan")),
        ("tilt-in-words", with(5, "down")),
        ("nothing", with(5, "")),
    ];
    for (name, table) in tables {
        damage.bytes(name, table);
    }
    damage.swap("half-a-frame", "\n412,", "\n412.5,");
    damage.swap("a-frame-below-zero", "\n412,", "\n-412,");
    damage.swap("zoom-below-zero", ",2410,", ",-2410,");
    damage.swap("millions-of-metres", ",18000,", ",18000000000000,");
    damage.swap("a-column-twice", "tilt_deg", "pan_deg");
    damage.swap("an-open-quote", "\n412,", "\n\"412,");
    add_missing_options(damage);
}

fn deepsport(damage: &mut Damage) {
    damage.bytes("nothing", "{}");
    damage.swap("three-numbers", "\"KK\":", "\"KK\":[1,2,3],\"was\":");
    damage.swap(
        "rows-as-lists",
        "\"R\":",
        "\"R\":[[1,0,0],[0,1,0],[0,0,1]],\"was\":",
    );
    damage.swap(
        "twice-as-large",
        "\"R\":",
        "\"R\":[2,0,0,0,2,0,0,0,2],\"was\":",
    );
    damage.swap("mirrored", "\"R\":", "\"R\":[1,0,0,0,1,0,0,0,-1],\"was\":");
    damage.swap("tangential", "\"kc\":", "\"kc\":[0.1,0,0.01,0,0],\"was\":");
    damage.swap("millions-of-metres", "\"T\":", "\"T\":[1e12,0,0],\"was\":");
    damage.swap(
        "width-in-words",
        "\"img_width\":",
        "\"img_width\":\"wide\",\"was\":",
    );
    damage.swap(
        "no-focal-length",
        "\"KK\":",
        "\"KK\":[0,0,0,0,0,0,0,0,1],\"was\":",
    );
    damage.swap(
        "skew",
        "\"KK\":",
        "\"KK\":[1000,3,0,0,1000,0,0,0,1],\"was\":",
    );
}

fn chan(damage: &mut Damage) {
    let line = "412\t0\t18\t60\t-11\t-12\t0\t25\n";
    damage.bytes("seven-columns", "412 0 18 60 -11 -12 0\n");
    damage.bytes("nine-columns", "412 0 18 60 -11 -12 0 25 1\n");
    damage.bytes("a-header", "frame tx ty tz rx ry rz vfov\n");
    damage.bytes("nan", format!("{line}413 0 18 nan -11 -12 0 25\n"));
    damage.bytes("no-view", "412 0 18 60 -11 -12 0 0\n");
    damage.bytes("focal-length-for-view", "412 0 18 60 -11 -12 0 2000\n");
    damage.bytes("half-a-frame", "4.5 0 18 60 -11 -12 0 25\n");
    damage.bytes("a-frame-below-zero", "-4 0 18 60 -11 -12 0 25\n");
    damage.bytes("a-frame-beyond-all", "1e300 0 18 60 -11 -12 0 25\n");
    damage.bytes("millions-of-metres", "412 0 1e9 60 -11 -12 0 25\n");
    damage.bytes("a-frame-twice", line.repeat(2));
    damage.options("no-size", |options| options.size = None);
}

fn authors_mat(damage: &mut Damage) {
    let words = |image: &'static str| vec![("image_name", Out::Words(image))];
    damage.bytes("hdf5", b"\x89HDF\r\n\x1a\n".to_vec());
    damage.bytes(
        "matlab-7.3",
        b"MATLAB 7.3 MAT-file, Platform: GLNXA64".to_vec(),
    );
    damage.bytes(
        "no-annotation",
        mat(&[("model", Out::Doubles(vec![1.0]))], false, false),
    );
    damage.bytes(
        "no-meta",
        mat(
            &[("annotation", Out::Structures(vec![frame("1.jpg", CAMERA)]))],
            false,
            false,
        ),
    );
    damage.bytes(
        "annotation-as-numbers",
        mat(&[("annotation", Out::Doubles(vec![1.0]))], false, false),
    );
    damage.bytes("no-camera", sequence(vec![words("1.jpg")], false));
    damage.bytes("nan", sequence(vec![frame("1.jpg", [f64::NAN; 9])], true));
    damage.bytes(
        "a-principal-point-in-no-picture",
        sequence(vec![frame("1.jpg", [0.0; 9])], true),
    );
    let elsewhere = [639.5, 359.5, 2000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    damage.bytes(
        "another-camera",
        sequence(vec![frame("1.jpg", elsewhere)], true),
    );
    let twice = [
        ("meta", Out::Doubles(vec![1.0])),
        ("meta", Out::Doubles(vec![2.0])),
    ];
    damage.bytes("a-variable-twice", mat(&twice, false, false));
    damage.bytes(
        "unfolds-to-32-mib",
        mat(&[("meta", Out::Doubles(vec![0.0; 4 << 20]))], false, true),
    );
    let mut deep = Out::Doubles(vec![1.0]);
    for _ in 0..100 {
        deep = Out::Structures(vec![vec![("a", deep)]]);
    }
    damage.bytes("deep", mat(&[("meta", deep)], false, false));
    let good = damage.sample.bytes(damage.sample.main()).to_vec();
    let with = |at: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        bytes
    };
    damage.bytes("a-size-of-gigabytes", with(132, &[0xff, 0xff, 0xff, 0x7f]));
    damage.bytes("another-type", with(128, &[99]));
}
