//! What is done to formats of clicks.

use crate::damage::Damage;
use crate::samples::Sample;
use touchline_documents::exchange::Format;

pub fn add(damage: &mut Damage) {
    match damage.sample.format {
        Format::SoccerNetLines => soccernet_lines(damage),
        Format::YoloPose => yolo(damage),
        Format::Coco => coco(damage),
        Format::Cvat => cvat(damage),
        Format::LabelStudio => label_studio(damage),
        Format::Labelme => labelme(damage),
        Format::Points => points(damage),
        _ => {}
    }
}

fn points(damage: &mut Damage) {
    damage.swap("no-labels", "frame,label,", "frame,name,");
    damage.swap("x-in-words", "444.68", "left");
    damage.swap("nan", "444.68", "nan");
    damage.swap("no-label", "centre_mark", "");
    damage.swap("unknown-label", "centre_mark", "the_middle");
    damage.swap("leaves-the-folder", "0001.jpg", "../0001.jpg");
    damage.swap("far-away", "444.68", "4e9");
    damage.options("no-size", |options| options.size = None);
}

fn soccernet_lines(damage: &mut Damage) {
    damage.bytes("lines-as-an-object", "{\"Middle line\": {}}");
    damage.bytes("points-as-lists", "{\"Middle line\": [[0.5, 0.5]]}");
    damage.bytes("no-y", "{\"Middle line\": [{\"x\": 0.5}]}");
    damage.bytes("pixels", "{\"Middle line\": [{\"x\": 960, \"y\": 540}]}");
    damage.bytes("null-x", "{\"Middle line\": [{\"x\": null, \"y\": 0.5}]}");
    damage.bytes(
        "unknown-class",
        "{\"Middle lane\": [{\"x\": 0.5, \"y\": 0.5}]}",
    );
    damage.bytes(
        "a-long-class",
        format!("{{\"{}\": 1}}", "x".repeat(100_000)),
    );
    damage.options("no-size", |options| options.size = None);
    let lines = std::mem::replace(&mut damage.sample, Sample::labels_v3());
    labels_v3(damage);
    damage.sample = lines;
}

fn labels_v3(damage: &mut Damage) {
    damage.bytes("v3-empty", "");
    damage.bytes("v3-a-list", "[]");
    damage.bytes(
        "v3-other-labels",
        "{\"UrlLocal\": \"a\", \"annotations\": []}",
    );
    damage.swap("v3-cut-short", "}}}\n", "");
    damage.swap(
        "v3-actions-as-a-list",
        "\"actions\":{",
        "\"actions\":[],\"was\":{",
    );
    damage.swap("v3-leaves-the-folder", "\"0.png\":{", "\"../../0.png\":{");
    damage.swap("v3-absolute-path", "\"0.png\":{", "\"/etc/0.png\":{");
    damage.swap("v3-another-disk", "\"0.png\":{", "\"C:\\\\0.png\":{");
    damage.swap("v3-an-image-twice", "\"0_1.png\":{", "\"0.png\":{");
    damage.swap("v3-no-width", "\"width\":1920", "\"broad\":1920");
    damage.swap("v3-huge-width", "\"width\":1920", "\"width\":1e18");
    damage.swap("v3-no-lines", "\"lines\":[", "\"paths\":[");
    damage.swap("v3-half-a-point", "960.25,", "");
    damage.swap("v3-points-as-lists", "960.25,270", "[960.25,270]");
    damage.swap("v3-a-word", "960.25", "\"left\"");
    damage.swap("v3-far-away", "960.25", "1e300");
    damage.swap("v3-a-class-as-a-number", "\"Middle line\"", "7");
    damage.swap("v3-unknown-class", "\"Middle line\"", "\"Middle lane\"");
    damage.swap("v3-a-box-without-a-side", "\"x2\":140,", "");
    damage.swap("v3-a-box-in-words", "\"x2\":140", "\"x2\":\"wide\"");
}

fn yolo(damage: &mut Damage) {
    damage.bytes("four-columns", "0 0.5 0.5 1\n");
    damage.bytes(
        "a-column-too-many",
        format!("{} 1\n", damage.sample.text().trim_end()),
    );
    let label = damage.sample.text();
    damage.swap("a-word", " 2", " two");
    damage.swap("nan", " 2", " nan");
    damage.swap("visible-three-times", " 2", " 3");
    let at = label.find(" 2").unwrap();
    let x = label[..at].rsplit(' ').nth(1).unwrap().to_owned();
    damage.swap("pixels", &x, "444.68");
    damage.swap("negative", &x, "-0.5");
    damage.swap_in("data.yaml", "a-name-less", "centre_mark, ", "");
    damage.swap_in("data.yaml", "unknown-name", "centre_mark, ", "the_middle, ");
    damage.bytes_of("names-not-utf8", "data.yaml", b"\xff".to_vec());
    damage.bytes_of("names-zipped", "data.yaml", b"PK\x03\x04".to_vec());
    damage.options("no-size", |options| options.size = None);
}

fn coco(damage: &mut Damage) {
    damage.bytes("nothing", "{}");
    damage.bytes(
        "no-frames",
        "{\"images\":[],\"annotations\":[],\"categories\":[]}",
    );
    damage.swap(
        "images-as-an-object",
        "\"images\":[",
        "\"images\":{\"a\":[],\"b\":[",
    );
    damage.swap("huge-width", "\"width\":1920", "\"width\":1e18");
    damage.swap("no-width", "\"width\":1920", "\"broad\":1920");
    damage.swap(
        "leaves-the-folder",
        "\"file_name\":\"0001.jpg\"",
        "\"file_name\":\"../../etc/passwd\"",
    );
    damage.swap(
        "absolute-path",
        "\"file_name\":\"0001.jpg\"",
        "\"file_name\":\"C:\\\\a.jpg\"",
    );
    damage.swap(
        "an-image-twice",
        "\"file_name\":\"0002.jpg\"",
        "\"file_name\":\"0001.jpg\"",
    );
    damage.swap("an-id-twice", "\"id\":2,\"width\"", "\"id\":1,\"width\"");
    damage.swap("unknown-image", "\"image_id\":1", "\"image_id\":99");
    damage.swap("unknown-category", "\"category_id\":1", "\"category_id\":9");
    damage.swap("a-number-less", "444.0,", "");
    damage.swap("a-word", "444.0,", "\"left\",");
    damage.swap("far-away", "444.0,", "1e300,");
    damage.swap("unknown-label", "\"centre_mark\"", "\"the_middle\"");
    damage.swap("a-label-as-a-number", "\"centre_mark\"", "7");
}

fn cvat(damage: &mut Damage) {
    let entities =
        "<!DOCTYPE a [<!ENTITY b \"c\"><!ENTITY d \"&b;&b;&b;\">]><annotations>&d;</annotations>";
    damage.bytes("entities", entities);
    damage.bytes("unknown-entity", "<annotations>&x;</annotations>");
    damage.bytes(
        "external-file",
        "<!DOCTYPE a SYSTEM \"file:///etc/passwd\"><annotations/>",
    );
    damage.bytes("no-frames", "<annotations/>");
    damage.bytes(
        "deep",
        format!("<annotations>{}", "<skeleton>".repeat(100_000)),
    );
    damage.swap("no-width", " width=\"1920\"", "");
    damage.swap("width-zero", " width=\"1920\"", " width=\"0\"");
    damage.swap("width-in-words", " width=\"1920\"", " width=\"wide\"");
    damage.swap("leaves-the-folder", "clip/0001.jpg", "../0001.jpg");
    damage.swap("one-coordinate", "444.68,789.18", "444.68");
    damage.swap("nan", "444.68,789.18", "nan,789.18");
    damage.swap("no-points", "444.68,789.18", "");
    damage.swap("far-away", "444.68,789.18", "1e300,0");
    damage.swap("no-label", " label=\"centre_mark\"", "");
    damage.swap("unknown-label", "\"centre_mark\"", "\"the middle\"");
    damage.swap("half-a-frame", "frame=\"3\"", "frame=\"3.5\"");
    damage.swap("a-frame-beyond-all", "frame=\"3\"", "frame=\"1e30\"");
    damage.swap("task-width", "<width>1920</width>", "<width>-5</width>");
    let image = damage.sample.text();
    let (begin, end) = (image.find("<image").unwrap(), image.find("<track").unwrap());
    let twice = format!("{}{}{}", &image[..end], &image[begin..end], &image[end..]);
    damage.bytes("an-image-twice", twice);
}

fn label_studio(damage: &mut Damage) {
    damage.bytes("an-empty-task", "[{}]");
    damage.bytes("no-frames", "[]");
    damage.bytes("tasks-as-an-object", "{\"tasks\": []}");
    damage.bytes("leaves-the-folder", "[{\"image\": \"..\"}]");
    damage.swap("turned", "\"image_rotation\": 0", "\"image_rotation\": 90");
    damage.swap("no-x", "\"x\": ", "\"left\": ");
    damage.swap("x-in-words", "\"x\": ", "\"x\": \"left\", \"was\": ");
    damage.swap("far-away", "\"x\": ", "\"x\": 1e300, \"was\": ");
    damage.swap(
        "beyond-all-numbers-once-scaled",
        "\"x\": ",
        "\"x\": 1e308, \"was\": ",
    );
    damage.swap(
        "a-flat-picture",
        "\"original_height\": 1080",
        "\"original_height\": 0",
    );
    damage.swap(
        "labels-as-a-text",
        "\"keypointlabels\": [",
        "\"keypointlabels\": \"a\", \"was\": [",
    );
    damage.swap("unknown-label", "\"centre_mark\"", "\"the middle\"");
    damage.swap("an-image-twice", "0002.jpg", "0001.jpg");
    damage.swap(
        "results-as-an-object",
        "\"result\": [",
        "\"result\": {}, \"was\": [",
    );
}

fn labelme(damage: &mut Damage) {
    damage.bytes("nothing", "{}");
    damage.swap(
        "leaves-the-folder",
        "\"imagePath\": \"0001.jpg\"",
        "\"imagePath\": \"..\\\\..\\\\a.jpg\"",
    );
    damage.swap(
        "path-as-a-number",
        "\"imagePath\": \"0001.jpg\"",
        "\"imagePath\": 7",
    );
    damage.swap(
        "an-image-twice",
        "\"imagePath\": \"0001.jpg\"",
        "\"imagePath\": \"0002.jpg\"",
    );
    damage.swap("huge-width", "\"imageWidth\": 1920", "\"imageWidth\": 1e9");
    damage.swap(
        "shapes-as-a-number",
        "\"shapes\": [",
        "\"shapes\": 1, \"was\": [",
    );
    damage.swap("no-shape-type", "\"shape_type\"", "\"type\"");
    damage.swap(
        "label-null",
        "\"label\": \"centre_mark\"",
        "\"label\": null",
    );
    damage.swap(
        "unknown-label",
        "\"label\": \"centre_mark\"",
        "\"label\": \"the middle\"",
    );
    damage.swap("far-away", "444.5", "-1e12");
    damage.swap("three-coordinates", "444.5", "444.5, 1, 2");
    damage.swap("x-in-words", "444.5", "\"left\"");
}
