//! Values derived from the document: computed on request, at most once for each version of the
//! document.
//!
//! Most values have a [`Memo`], whose key is the document's version. Values that depend on all
//! frames are updated from the frames that changed since the last request, so that an edit in a
//! document of 100,000 frames costs what one frame costs. [`Current`](crate::app::Current), the
//! review list and the quality page depend on these values and on the user's choices.

mod frame_counts;

pub use frame_counts::FrameCounts;

use crate::app::Versioned;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use touchline_calibration::calibrate::{Disagreements, FrameLookup, OwnNoise, can_choose_gold};
use touchline_calibration::proposals::{Coverage, LabelAdvice, LabelNeeds};
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_documents::document::{ClickNoise, Document, FieldSpec, Fields, Frame};

/// The values derived from a document.
#[derive(Clone, Debug, Default)]
pub(in crate::app) struct Derived {
    lookup: Memo<FrameLookup>,
    counts: Memo<FrameCounts>,
    disagreements: Memo<Disagreements>,
    fields: Memo<FieldModels>,
    templates: Templates,
    gold: Gold,
    advice: Advice,
}

impl Follows for FrameLookup {
    fn update(&mut self, document: &Document) {
        Self::update(self, document);
    }
}

impl Follows for Disagreements {
    fn update(&mut self, document: &Document) {
        Self::update(self, document);
    }
}

impl Derived {
    /// Index of the frames for the calibration.
    pub(in crate::app) fn lookup(&mut self, document: &Versioned<Document>) -> &FrameLookup {
        self.lookup.at(document)
    }

    /// The counts of frames by kind.
    pub(in crate::app) fn counts(&mut self, document: &Versioned<Document>) -> &FrameCounts {
        self.counts.at(document)
    }

    /// The counts at their last request.
    pub(super) const fn last_counts(&self) -> &FrameCounts {
        self.counts.last()
    }

    /// The disagreements of solved frames with their neighbours.
    pub(in crate::app) fn disagreements(
        &mut self,
        document: &Versioned<Document>,
    ) -> &Disagreements {
        self.disagreements.at(document)
    }

    /// A field of the document, with the click noise that the document uses.
    pub(in crate::app) fn field(
        &mut self,
        document: &Versioned<Document>,
        spec: &FieldSpec,
    ) -> Result<Arc<FieldModel>, FieldError> {
        self.fields
            .at_mut(document)
            .model(document, spec, &mut self.templates)
    }

    /// The fields of all cameras.
    pub(in crate::app) fn fields(
        &mut self,
        document: &Versioned<Document>,
    ) -> Result<Arc<Fields>, FieldError> {
        self.fields
            .at_mut(document)
            .all(document, &mut self.templates)
    }

    /// The field of a frame in a document that differs from the open one.
    pub(in crate::app) fn field_in(
        &mut self,
        document: &Document,
        frame: &Frame,
    ) -> Result<FieldModel, FieldError> {
        self.templates
            .weighted_field(document, document.field_of(frame))
    }

    /// The templates that must be read before a field can be built. Each is returned once.
    pub(in crate::app) fn take_wanted_templates(&mut self) -> Vec<String> {
        self.templates.take_wanted()
    }

    /// Stores a template that was read, or the error. Fields that use it are built with the
    /// document's next version.
    pub(in crate::app) fn template_read(
        &mut self,
        name: &str,
        template: Result<Box<Template>, FieldError>,
    ) {
        self.templates.put(name, template);
    }

    /// Requests the templates that could not be read once more, because their files may have been
    /// corrected.
    pub(in crate::app) fn want_failed_templates_again(&mut self) {
        // Forget the fields, too: their errors are stored with them.
        self.templates.want_failed_again();
        self.fields = Memo::default();
        self.gold.forget();
    }

    /// Advice where to label next, for the document after its journalled edit `revision`.
    /// `coverage` says where references look. If no frame lacks an answer, nothing is computed.
    pub(in crate::app) fn label_advice(
        &mut self,
        document: &Versioned<Document>,
        revision: u64,
        coverage: &Arc<[Coverage]>,
    ) -> LabelAdvice {
        let counts = self.counts.at(document);
        if (counts.unanswered, counts.uncertain) == (0, 0) {
            return LabelAdvice::default();
        }
        self.advice.at(document, revision, coverage)
    }

    /// The values about gold frames and their repeats.
    pub(in crate::app) fn gold(&mut self, document: &Versioned<Document>) -> &GoldWork {
        let counts = self.counts.at(document);
        self.gold.update(document, counts, &mut self.templates);
        &self.gold.work
    }

    /// The values about gold frames at their last request.
    pub(in crate::app) const fn last_gold(&self) -> &GoldWork {
        &self.gold.work
    }
}

/// All fields that a document names: the cameras' own, then the document's. May contain duplicates.
fn field_specs(document: &Document) -> Vec<FieldSpec> {
    document.fields().cloned().collect()
}

/// A value that can be computed from a document.
trait Follows: Default {
    /// Updates the value for `document`. The value starts as the default; later it is the value for
    /// the document of the previous update, so that only the differences need work.
    fn update(&mut self, document: &Document);
}

/// A value and the version of the document for which it was computed.
#[derive(Clone, Debug, Default)]
struct Memo<T> {
    value: T,
    version: Option<u64>,
}

impl<T: Follows> Memo<T> {
    /// The value for the present document.
    fn at(&mut self, document: &Versioned<Document>) -> &T {
        self.at_mut(document)
    }

    /// The same with write access, for a value that extends itself on request.
    fn at_mut(&mut self, document: &Versioned<Document>) -> &mut T {
        let version = Some(document.version());
        if self.version != version {
            self.value.update(document);
            self.version = version;
        }
        &mut self.value
    }

    /// The value at the last request.
    const fn last(&self) -> &T {
        &self.value
    }
}

/// Values about gold frames and their repeats: derived, never stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GoldWork {
    /// Number of gold frames that are references.
    pub frames: usize,
    /// Whether the program could choose more references as gold frames.
    pub can_choose: bool,
    /// The annotator's click noise, measured from the repeats.
    pub own: OwnNoise,
}

/// The values, and the inputs of the click noise.
#[derive(Clone, Debug, Default)]
struct Gold {
    work: GoldWork,
    /// The edition of the repeats, and the fields on which they were clicked.
    measured: Option<(u64, Vec<FieldSpec>)>,
}

impl Gold {
    /// Makes the next update measure the click noise again, because fields may have changed.
    fn forget(&mut self) {
        self.measured = None;
    }

    /// Updates the values for a document with the given counts. The click noise is measured again
    /// only if repeats or fields have changed.
    fn update(&mut self, document: &Document, counts: &FrameCounts, templates: &mut Templates) {
        self.work.frames = counts.gold_references;
        self.work.can_choose = can_choose_gold(counts.gold, counts.could_be_gold);
        let of = (counts.repeats_edition(), field_specs(document));
        if self.measured.as_ref() != Some(&of) {
            let fields = Fields::with(document, |spec| {
                templates.unweighted_field(spec).map(Arc::new)
            });
            // While a template is being read, the next update tries again.
            self.measured = (!matches!(fields, Err(FieldError::BeingRead { .. }))).then_some(of);
            // The error of an invalid field is shown elsewhere.
            let own = fields.map(|fields| {
                OwnNoise::estimate_from_frames(document, &fields, counts.with_repeats())
            });
            self.work.own = own.unwrap_or_default();
        }
    }
}

/// The advice, and the inputs from which it was computed.
#[derive(Clone, Debug, Default)]
struct Advice {
    needs: Memo<LabelNeeds>,
    given: LabelAdvice,
    given_for: Option<GivenFor>,
}

#[derive(Clone, Debug)]
struct GivenFor {
    /// The number of journalled edits.
    revision: u64,
    /// The edition of the needs; it grows with every change of them.
    edition: u64,
    /// The coverage by references.
    coverage: Arc<[Coverage]>,
}

impl Follows for LabelNeeds {
    fn update(&mut self, document: &Document) {
        Self::update(self, document);
    }
}

impl Advice {
    /// The advice for a document after its journalled edit `revision`. It does not change during a
    /// drag, which is journalled as one edit at its end.
    fn at(
        &mut self,
        document: &Versioned<Document>,
        revision: u64,
        coverage: &Arc<[Coverage]>,
    ) -> LabelAdvice {
        let known = self
            .given_for
            .as_ref()
            .filter(|known| Arc::ptr_eq(&known.coverage, coverage));
        // Two levels: without a new edit nothing is examined, and after an edit that leaves the
        // needs as they are the advice stays.
        if known.is_some_and(|known| known.revision == revision) {
            return self.given;
        }
        let known_edition = known.map(|known| known.edition);
        let needs = self.needs.at(document);
        let edition = needs.edition();
        if known_edition != Some(edition) {
            self.given = LabelAdvice::from_needs(needs, coverage);
        }
        self.given_for = Some(GivenFor {
            revision,
            edition,
            coverage: Arc::clone(coverage),
        });
        self.given
    }
}

/// The fields that were requested, with the document's click noise.
#[derive(Clone, Debug, Default)]
struct FieldModels {
    click_noise: Option<ClickNoise>,
    models: Vec<(FieldSpec, Result<Arc<FieldModel>, FieldError>)>,
    /// The fields of all cameras, and the specifications from which they were built.
    all: Option<(Vec<FieldSpec>, Arc<Fields>)>,
}

impl Follows for FieldModels {
    fn update(&mut self, document: &Document) {
        // The models contain the σ of clicks, so that another click noise makes all of them
        // obsolete. Otherwise drop those that the document does not name any more: a number that is
        // dragged would leave one behind at each step.
        let (click_noise, specs) = (document.click_noise_in_use(), field_specs(document));
        if click_noise != self.click_noise {
            *self = Self {
                click_noise,
                ..Self::default()
            };
        }
        self.models.retain(|(spec, _)| specs.contains(spec));
        self.all.take_if(|(known, _)| *known != specs);
    }
}

impl FieldModels {
    /// One field, with its parameters. A field whose template is still being read is not kept.
    fn model(
        &mut self,
        document: &Document,
        spec: &FieldSpec,
        templates: &mut Templates,
    ) -> Result<Arc<FieldModel>, FieldError> {
        if let Some((_, known)) = self.models.iter().find(|(known, _)| known == spec) {
            return known.clone();
        }
        let model = templates.weighted_field(document, spec).map(Arc::new);
        if !matches!(model, Err(FieldError::BeingRead { .. })) {
            self.models.push((spec.clone(), model.clone()));
        }
        model
    }

    /// The fields of all cameras.
    fn all(
        &mut self,
        document: &Document,
        templates: &mut Templates,
    ) -> Result<Arc<Fields>, FieldError> {
        if let Some((_, known)) = &self.all {
            return Ok(Arc::clone(known));
        }
        let fields = Arc::new(Fields::with(document, |spec| {
            self.model(document, spec, templates)
        })?);
        self.all = Some((field_specs(document), Arc::clone(&fields)));
        Ok(fields)
    }
}

/// The state of a template.
#[derive(Clone, Debug)]
enum Reading {
    /// Needed, but not requested yet.
    Wanted,
    Requested,
    Done(Result<Box<Template>, FieldError>),
}

/// The templates that a document's fields name. The keys are their paths as the document writes
/// them.
#[derive(Clone, Debug, Default)]
struct Templates(BTreeMap<String, Reading>);

impl Templates {
    /// A field with the click noise that its template states.
    fn unweighted_field(&mut self, spec: &FieldSpec) -> Result<FieldModel, FieldError> {
        // Built-in templates are compiled in: the folder is of no importance.
        if !spec.is_file() {
            return spec.model(Path::new(""));
        }
        let reading = self
            .0
            .entry(spec.template.clone())
            .or_insert(Reading::Wanted);
        let Reading::Done(template) = reading else {
            return Err(FieldError::BeingRead {
                place: spec.template.clone(),
            });
        };
        spec.model_of_template(template.as_ref().map_err(FieldError::clone)?)
    }

    /// A field with the click noise that a document uses.
    fn weighted_field(
        &mut self,
        document: &Document,
        spec: &FieldSpec,
    ) -> Result<FieldModel, FieldError> {
        let mut field = self.unweighted_field(spec)?;
        document.weight_clicks(&mut field);
        Ok(field)
    }

    /// The templates to be read; each is returned once.
    fn take_wanted(&mut self) -> Vec<String> {
        let wanted = self
            .0
            .iter_mut()
            .filter(|(_, reading)| matches!(reading, Reading::Wanted));
        wanted
            .map(|(name, reading)| {
                *reading = Reading::Requested;
                name.clone()
            })
            .collect()
    }

    /// Requests the templates that could not be read once more.
    fn want_failed_again(&mut self) {
        for reading in self
            .0
            .values_mut()
            .filter(|reading| matches!(reading, Reading::Done(Err(_))))
        {
            *reading = Reading::Wanted;
        }
    }

    /// Stores a template that was read, or the error.
    fn put(&mut self, name: &str, template: Result<Box<Template>, FieldError>) {
        self.0.insert(name.to_owned(), Reading::Done(template));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::Camera;
    use touchline_documents::testing::soccer_document;

    /// Counts its updates.
    #[derive(Default)]
    struct Counted(usize);

    impl Follows for Counted {
        fn update(&mut self, _: &Document) {
            self.0 += 1;
        }
    }

    #[test]
    fn a_value_is_derived_once_for_each_version_and_not_before_it_is_requested() {
        let mut document = Versioned::new(soccer_document());
        let mut memo = Memo::<Counted>::default();
        assert_eq!(memo.last().0, 0);
        assert_eq!((memo.at(&document).0, memo.at(&document).0), (1, 1));
        document.generator = "another".to_owned();
        document.generator = "a third".to_owned();
        assert_eq!(memo.last().0, 1, "not requested yet");
        assert_eq!((memo.at(&document).0, memo.at(&document).0), (2, 2));
        document.keeping_version().generator = "a fourth".to_owned();
        assert_eq!(memo.at(&document).0, 2);
    }

    #[test]
    fn a_field_is_built_once_until_the_document_names_another() {
        let mut document = soccer_document();
        let (mut models, mut templates) = (FieldModels::default(), Templates::default());
        let mut model = |document: &Document| {
            models.update(document);
            let model = models
                .model(document, &document.field, &mut templates)
                .unwrap();
            (model, models.all(document, &mut templates).unwrap())
        };
        let (first, all) = model(&document);
        document
            .cameras
            .push(Camera::new("main".into(), ImageSize::new(64, 36)).into());
        let (same, same_all) = model(&document);
        assert!(Arc::ptr_eq(&first, &same) && Arc::ptr_eq(&all, &same_all));
        assert!(
            Arc::ptr_eq(&same_all.per_camera(&document)[0], &first),
            "one model for both"
        );
        document.field.params.insert("length_m".to_owned(), 100.0);
        let (longer, longer_all) = model(&document);
        assert!(!Arc::ptr_eq(&first, &longer) && !Arc::ptr_eq(&all, &longer_all));
        document.field.params.insert("length_m".to_owned(), -1.0);
        models.update(&document);
        assert!(
            models
                .model(&document, &document.field, &mut templates)
                .is_err()
        );
        assert!(models.all(&document, &mut templates).is_err());
    }
}
