//! The camera under other names, where lines are far from where they are named.

use super::hypotheses::{FittedPicture, fit_picture};
use super::{FromLinesOptions, LinePicture, names};
use crate::field::Symmetry;
use crate::solve::{Evidence, IdentityFinding, IdentityKind, Observation};

/// The mirrored sets of names that are tried.
const MIRRORS: [Symmetry; 2] = [Symmetry::MirrorX, Symmetry::MirrorY];

/// A mirrored set of names has to lower the cost by this amount, and to this fraction.
const MIN_GAIN: f64 = 25.0;
const MAX_SHARE: f64 = 0.25;

/// New names for single lines may raise the cost by this amount: a line that is extended to where
/// another one lies fits as well.
const MAX_RISE: f64 = 4.0;

/// A picture fitted under other names.
struct Renamed {
    fitted: FittedPicture,
    finding: IdentityFinding,
}

/// The better one of a fitted picture and the same under other names, with what was wrong.
pub(super) fn correct_names(
    picture: &LinePicture<'_>,
    used: &[Observation],
    as_named: FittedPicture,
    options: &FromLinesOptions,
) -> (FittedPicture, Option<IdentityFinding>) {
    // Single names first, because they change less.
    let better = rename_lines(picture, used, &as_named, options)
        .or_else(|| mirror_names(picture, used, &as_named, options));
    match better {
        Some(Renamed { fitted, finding }) => (fitted, Some(finding)),
        None => (as_named, None),
    }
}

/// New names for the lines that lie on other lines of the field.
fn rename_lines(
    picture: &LinePicture<'_>,
    used: &[Observation],
    as_named: &FittedPicture,
    options: &FromLinesOptions,
) -> Option<Renamed> {
    let camera = as_named.found.state.camera();
    let new_names = names::find_new_names(picture.field, &camera, &as_named.lines, used);
    if new_names.is_empty() {
        return None;
    }
    // The picture is solved again from the beginning, because the starts depend on the names.
    let observations = names::rename(picture.field, used, &new_names)?;
    let fitted = fit_picture(picture, &observations, options).ok()?;
    if fitted.found.cost > as_named.found.cost + MAX_RISE {
        return None;
    }
    let as_named_px = new_names.iter().map(|name| name.as_named_px);
    let renamed_px = new_names.iter().map(|name| name.renamed_px);
    let finding = IdentityFinding {
        kind: names::kind_of(&new_names),
        evidence: Evidence::Clicks,
        renames: names::renames(picture.field, used, &observations),
        ptz: fitted.found.state.ptz,
        as_named_px: as_named_px.fold(0.0, f64::max),
        renamed_px: renamed_px.fold(0.0, f64::max),
    };
    Some(Renamed { fitted, finding })
}

/// All names of the mirrored field, where many lines are far from where they are named.
fn mirror_names(
    picture: &LinePicture<'_>,
    used: &[Observation],
    as_named: &FittedPicture,
    options: &FromLinesOptions,
) -> Option<Renamed> {
    if !names::many_are_far(&as_named.found.state.camera(), &as_named.lines) {
        return None;
    }
    // Both conditions at once: the smaller limit is the stricter one.
    let cost = as_named.found.cost;
    let limit = (MAX_SHARE * cost).min(cost - MIN_GAIN);
    let mut best: Option<Renamed> = None;
    for symmetry in MIRRORS {
        let Some(observations) = names::mirror(picture.field, used, symmetry) else {
            continue;
        };
        let Ok(fitted) = fit_picture(picture, &observations, options) else {
            continue;
        };
        let lowest = best.as_ref().map_or(limit, |best| best.fitted.found.cost);
        if fitted.found.cost < lowest {
            let finding = IdentityFinding {
                kind: IdentityKind::Mirrored(symmetry),
                evidence: Evidence::Clicks,
                renames: names::renames(picture.field, used, &observations),
                ptz: fitted.found.state.ptz,
                as_named_px: as_named.median_px(),
                renamed_px: fitted.median_px(),
            };
            best = Some(Renamed { fitted, finding });
        }
    }
    best
}
