//! The document as a whole.

use crate::document::{
    Camera, CameraId, ClickNoise, Extra, FieldSpec, Frame, FrameLens, Frames, Shared, Shot,
    StoredClickNoise,
};
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use touchline_core::camera::{CameraBase, PtzCamera, StatedLens};
use touchline_core::field::FieldModel;
use touchline_core::geometry::PixelBox;

/// The value of `format` in every document of this program.
pub const FORMAT_NAME: &str = "touchline";
/// The newest `version` that this program reads, and the one it writes.
pub const DOCUMENT_VERSION: u64 = 1;

/// The value of `generator` in documents that this program writes.
pub fn generator() -> String {
    format!("touchline {}", env!("CARGO_PKG_VERSION"))
}

/// A project or dataset: a field, cameras, frames.
///
/// Cloning is cheap: cameras and frames are shared until one is changed, so undo keeps whole
/// documents.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The program that wrote the file; when writing, this program writes its own name.
    pub generator: String,
    /// The conventions in words, for human readers.
    pub conventions: Map<String, Value>,
    /// The field, unless a camera has its own.
    pub field: FieldSpec,
    /// The cameras.
    pub cameras: Vec<Shared<Camera>>,
    /// The frames, in the order in which the user steps through them.
    pub frames: Frames,
    /// Its click noise.
    pub click_noise: Option<StoredClickNoise>,
    /// The shots of its videos, marked by the user or found by the program.
    pub shots: Vec<Shot>,
    /// Unknown keys.
    pub extra: Extra,
}

impl Document {
    /// An empty document on a field.
    pub fn new(field: FieldSpec) -> Self {
        Self {
            generator: generator(),
            conventions: conventions(),
            field,
            cameras: Vec::new(),
            frames: Frames::new(),
            click_noise: None,
            shots: Vec::new(),
            extra: Extra::new(),
        }
    }

    /// Whether everything but the frames is equal.
    pub fn same_beside_frames(&self, other: &Self) -> bool {
        // A copy of the other document takes our frames and our generator, so that the derived
        // comparison covers every other key, also one that is added to the type later. The copy is
        // cheap, because cameras are shared.
        *self
            == Self {
                generator: self.generator.clone(),
                frames: self.frames.clone(),
                ..other.clone()
            }
    }

    /// A camera by name.
    pub fn camera(&self, id: &CameraId) -> Option<&Camera> {
        let mut cameras = self.cameras_near_number(id).iter().chain(&self.cameras);
        cameras
            .find(|camera| camera.id == *id)
            .map(|camera| &**camera)
    }

    /// The cameras at about the place that the number in a name says. An import of thousands of
    /// cameras calls them `main`, `main-2`, … in their order; a search from the first for each
    /// frame's would take time with the square of their number.
    fn cameras_near_number(&self, id: &CameraId) -> &[Shared<Camera>] {
        /// Names count from 1 or 2, places from 0.
        const AROUND: usize = 3;
        let name = id.as_str();
        let digits = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let number: usize = name[digits.len()..].parse().unwrap_or(0);
        let last = number.saturating_add(1).min(self.cameras.len());
        &self.cameras[last.saturating_sub(AROUND)..last]
    }

    /// A camera by name, to change it.
    pub fn camera_mut(&mut self, id: &CameraId) -> Option<&mut Camera> {
        self.cameras
            .iter_mut()
            .find(|camera| camera.id == *id)
            .map(|camera| &mut **camera)
    }

    /// A camera's name with the first free number after it: “main 2”.
    pub fn free_camera_name(&self, like: &CameraId) -> CameraId {
        // A number at the end is replaced, not extended: a copy of “main 2” is “main 3”.
        let stem = like
            .as_str()
            .trim_end_matches(|c: char| c.is_ascii_digit())
            .trim_end();
        // A name of digits alone leaves no stem.
        let stem = if stem.is_empty() { "camera" } else { stem };
        // A stem that ends in a separator, such as “cam_”, needs no space.
        let gap = if stem.ends_with(['-', '_', '.']) {
            ""
        } else {
            " "
        };
        let mut number = 2;
        loop {
            let name = CameraId::from(format!("{stem}{gap}{number}").as_str());
            if self.camera(&name).is_none() {
                return name;
            }
            number += 1;
        }
    }

    /// The names of the cameras that frames are of.
    pub fn used_cameras(&self) -> BTreeSet<CameraId> {
        let of_frames = self.frames.iter().map(|frame| frame.camera.clone());
        of_frames.collect()
    }

    /// The fields of the cameras that have one of their own, then the document's.
    pub fn fields(&self) -> impl Iterator<Item = &FieldSpec> {
        let cameras = self.cameras.iter();
        cameras
            .filter_map(|camera| camera.field.as_ref())
            .chain([&self.field])
    }

    /// The same, to change them.
    pub fn fields_mut(&mut self) -> impl Iterator<Item = &mut FieldSpec> {
        // A shared camera is copied when it is borrowed to be changed, so cameras without a field
        // are left out before that.
        let with_field = self
            .cameras
            .iter_mut()
            .filter(|camera| camera.field.is_some());
        with_field
            .filter_map(|camera| camera.field.as_mut())
            .chain([&mut self.field])
    }

    /// Adds a copy of a camera under a free name like its own, and returns that name.
    pub fn add_copy(&mut self, camera: &Camera) -> CameraId {
        let id = self.free_camera_name(&camera.id);
        let copy = Camera {
            id: id.clone(),
            ..camera.clone()
        };
        self.cameras.push(copy.into());
        id
    }

    /// The name of a camera like another one, with this base: one of the document's, or a copy that
    /// is added. None if the other one is not in the document.
    pub fn camera_with_base(&mut self, like: &CameraId, base: &CameraBase) -> Option<CameraId> {
        let mut wanted = self.camera(like)?.clone();
        wanted.set_base(base);
        let base = wanted.base();
        let mut known = self.cameras.iter();
        let known = known.find(|known| {
            known.base() == base
                && known.image_size == wanted.image_size
                && known.field == wanted.field
        });
        let known = known.map(|known| known.id.clone());
        Some(known.unwrap_or_else(|| self.add_copy(&wanted)))
    }

    /// The camera that took a frame.
    pub fn camera_of(&self, frame: &Frame) -> Option<&Camera> {
        self.camera(&frame.camera)
    }

    /// The lens of a frame as it is stated: the frame's own, or that of its camera.
    pub fn stated_lens(&self, frame: &Frame) -> StatedLens {
        let own = frame.lens.as_ref().map(FrameLens::stated_lens);
        let of_camera = || self.camera_of(frame).map(Camera::stated_lens);
        own.or_else(of_camera).unwrap_or_default()
    }

    /// The field that a frame shows: its camera's own, else the document's.
    pub fn field_of(&self, frame: &Frame) -> &FieldSpec {
        self.field_of_camera(&frame.camera)
    }

    /// The field that a camera looks at: its own, else the document's.
    pub fn field_of_camera(&self, camera: &CameraId) -> &FieldSpec {
        self.camera(camera)
            .and_then(|camera| camera.field.as_ref())
            .unwrap_or(&self.field)
    }

    /// States the field of a camera of its own, or the one that all others share. Where its size
    /// is another or comes from elsewhere, the cameras say no more what their frames left open of
    /// it.
    pub fn state_field(&mut self, camera: Option<&CameraId>, field: FieldSpec) {
        let own = camera.filter(|id| self.camera(id).is_some_and(|it| it.field.is_some()));
        let shares = |it: &Camera| own.map_or(it.field.is_none(), |own| it.id == *own);
        let before = own.map_or(&self.field, |own| self.field_of_camera(own));
        let is_same = before.is_same_field(&field) && before.size == field.size;
        for camera in self.cameras.iter_mut().filter(|it| shares(it)) {
            if !is_same && camera.states_open_size() {
                let camera = &mut **camera;
                if let Some(sigma) = &mut camera.sigma {
                    (sigma.length, sigma.width) = (None, None);
                }
            }
            if own.is_some() {
                camera.field = Some(field.clone());
            }
        }
        if own.is_none() {
            self.field = field;
        }
    }

    /// The camera of a solved frame, as it is shown and exported.
    pub fn ptz_camera(&self, frame: &Frame) -> Option<PtzCamera> {
        self.camera_of(frame)?.ptz_camera(frame)
    }

    /// All masks of a frame, its camera's and its own: boxes excluded from feature detection.
    pub fn masks_of(&self, frame: &Frame) -> Vec<PixelBox> {
        let Some(camera) = self.camera_of(frame) else {
            return frame.masks.clone();
        };
        let ranged = camera
            .ranged_masks
            .iter()
            .filter(|mask| mask.covers(frame))
            .map(|mask| &mask.pixel_box);
        camera
            .masks
            .iter()
            .chain(ranged)
            .chain(&frame.masks)
            .copied()
            .collect()
    }

    /// The annotator's own click noise, whether it is in use or not.
    pub const fn own_click_noise(&self) -> Option<&ClickNoise> {
        match &self.click_noise {
            Some(StoredClickNoise::Own(noise)) => Some(noise),
            Some(StoredClickNoise::Unreadable(_)) | None => None,
        }
    }

    /// The click noise that weights its clicks; none: the template's.
    pub fn click_noise_in_use(&self) -> Option<ClickNoise> {
        self.own_click_noise()
            .filter(|noise| noise.in_use && noise.is_plausible())
            .cloned()
    }

    /// Stores the annotator's own click noise.
    ///
    /// # Errors
    /// One of its numbers is not finite, or not positive where it has to be.
    pub fn set_click_noise(&mut self, noise: &ClickNoise) -> Result<(), serde_json::Error> {
        // To serialise is to check: the adapters refuse numbers that a document cannot hold. Found
        // later, such a number would keep the whole document from being written.
        serde_json::to_value(noise)?;
        self.click_noise = Some(StoredClickNoise::Own(noise.clone()));
        Ok(())
    }

    /// Sets the click sigmas of a field by the click noise that the document uses.
    pub fn weight_clicks(&self, field: &mut FieldModel) {
        if let Some(noise) = self.click_noise_in_use() {
            noise.apply(field);
        }
    }
}

/// The conventions as every document states them.
pub(in crate::document) fn conventions() -> Map<String, Value> {
    [
        (
            "world",
            "origin field centre; x right along the length seen from the main camera; y away from it; z up; metres",
        ),
        ("image", "(0,0) is the top-left corner of the image; x right, y down; pixel centres at +0.5"),
        ("rotation", "cam_from_world = Q_tilt(tilt) Q_pan(pan) base_from_world; x right, y down, z forward"),
        ("angles", "degrees; pan positive right, tilt positive up"),
    ]
    .into_iter()
    .map(|(key, text)| (key.to_owned(), Value::from(text)))
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn a_camera_is_found_by_its_name_wherever_it_lies() {
        let mut document = Document::new(FieldSpec::new("soccer"));
        let size = ImageSize::new(64, 36);
        let names = [
            "main",
            "main-2",
            "7",
            "main-4",
            "main-3",
            "b1",
            "main-99999999999999999999",
        ];
        for name in names {
            document.cameras.push(Camera::new(name.into(), size).into());
        }
        for name in names {
            let found = document.camera(&name.into());
            assert_eq!(found.map(|camera| camera.id.as_str()), Some(name));
        }
        assert!(document.camera(&"main-5".into()).is_none());
        assert!(
            Document::new(FieldSpec::new("soccer"))
                .camera(&"1".into())
                .is_none()
        );
    }
}
