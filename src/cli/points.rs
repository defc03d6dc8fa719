//! `touchline points`: lists the points that models gave, removes them, and writes what became of
//! them.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, DocumentOutput, Loaded};
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{print, refuse_existing_file, write_file};
use anyhow::ensure;
use serde_json::json;
use std::path::PathBuf;
use touchline_core::geometry::pluralise;
use touchline_documents::document::Document;
use touchline_documents::exchange::point_outcomes;

/// Lists the points of models in a document (`import --points`), removes them together, or writes
/// what became of each.
#[derive(clap::Args, Debug)]
pub struct PointsArgs {
    #[command(flatten)]
    document: DocumentArg,
    /// Only points of this model.
    #[arg(long, value_name = "NAME")]
    model: Option<String>,
    /// Remove the points, and cameras that rest on them alone, unless a person moved the point or
    /// accepted the frame's camera.
    #[arg(long, requires = "output", conflicts_with = "outcomes")]
    remove: bool,
    /// The JSON file to write: of each point whether it was accepted, moved (by how many px) or
    /// refused, and its distance from what the frame's camera projects.
    #[arg(long, value_name = "JSON")]
    outcomes: Option<PathBuf>,
    #[command(flatten)]
    output: DocumentOutput,
}

/// What the document holds of each model, as a line for each or as JSON.
fn list(document: &Document, messages: Messages) -> String {
    let models = document.points_of_models();
    if matches!(messages, Messages::Json) {
        let models = models.iter().map(|(name, [given, moved, refused])| {
            json!({ "model": name, "given": given, "moved": moved, "refused": refused })
        });
        return format!("{:#}\n", json!({ "models": models.collect::<Vec<_>>() }));
    }
    let lines = models.iter().map(|(name, [given, moved, refused])| {
        let points = pluralise(given + moved + refused, "point");
        format!("{name}: {points}, {moved} moved by a person, {refused} refused\n")
    });
    lines.collect()
}

/// Lists, removes or describes the points.
///
/// # Errors
/// The document cannot be read, has no such points, or the result cannot be written.
pub fn points(args: &PointsArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let input = &args.document.document;
    let of_model = args.model.as_deref();
    if args.remove {
        let output = args.output.reserve("points --remove", &[input], messages)?;
        let Loaded {
            location,
            mut document,
        } = output.read(input)?;
        refuse_other_models(&document, of_model)?;
        let before = document.clone();
        let mut removed = 0;
        for index in 0..document.frames.len() {
            removed += document.frames[index].remove_points_of(of_model);
        }
        document.count_edits_since(&before);
        drop(before);
        output.write(document, location.folder())?;
        messages.note(&format!("{} removed", pluralise(removed, "point")));
        return Ok(Outcome::Done);
    }
    ensure!(
        args.output.output.is_none(),
        "-o is for --remove; the list goes to standard output, and --outcomes names its own file"
    );
    if let Some(path) = &args.outcomes {
        refuse_existing_file(path, args.output.force)?;
    }
    let Loaded { location, document } = args.document.load(messages)?;
    refuse_other_models(&document, of_model)?;
    let Some(path) = &args.outcomes else {
        print(&list(&document, messages))?;
        return Ok(Outcome::Done);
    };
    let outcomes = point_outcomes(document.at(location.folder()), of_model)?;
    write_file(
        path,
        format!("{outcomes:#}\n").as_bytes(),
        args.output.force,
    )?;
    Ok(Outcome::Done)
}

/// Refuses the name of a model that gave no point.
fn refuse_other_models(document: &Document, model: Option<&str>) -> anyhow::Result<()> {
    let models = document.points_of_models();
    let Some(model) = model else {
        ensure!(
            !models.is_empty(),
            "the document has no points of models; `touchline import --points` reads some"
        );
        return Ok(());
    };
    let known: Vec<&str> = models.keys().map(String::as_str).collect();
    ensure!(
        models.contains_key(model),
        "the document has no points of {model:?}; its models: {}",
        if known.is_empty() {
            "none".to_owned()
        } else {
            known.join(", ")
        }
    );
    Ok(())
}
