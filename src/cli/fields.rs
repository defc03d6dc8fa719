//! `touchline fields`: lists and draws field templates.

use super::Outcome;
use super::new::parameter;
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{encode_png, ending, print, refuse_existing_file, write_file};
use anyhow::{bail, ensure};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_application::render::{Layer, Offscreen, View};
use touchline_application::scene::OverlayStyle;
use touchline_application::scene::field_map::{FieldMap, SURROUND, field_map};
use touchline_application::scene::overlay::OverlayScene;
use touchline_core::field::{
    Curve, FieldLine, FieldModel, Template, builtin, builtin_names, builtin_text, svg,
    template_named,
};
use touchline_core::geometry::{Vec3, decimal};

/// Margin around the field on a PNG, m.
const MAP_MARGIN_M: f64 = 3.0;
/// Length of the longer side of a PNG, px, rounded.
const MAP_WIDTH_PX: f64 = 1600.0;

/// Lists the field templates: parameters with their ranges and sources, landmarks with coordinates,
/// lines.
#[derive(clap::Args, Debug)]
pub struct FieldsArgs {
    /// A built-in template, or the path of your own (a file ending in .json); all built-in ones if
    /// none is named.
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// A parameter of the named template: `length_m=105`; may be repeated.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = parameter)]
    set: Vec<(String, f64)>,
    /// Draw the named template from above, into an SVG or a PNG.
    #[arg(long, value_name = "FILE")]
    render: Option<PathBuf>,
    /// Write the named built-in template as a file, to make one of your own of it.
    #[arg(long, value_name = "FILE", requires = "name", conflicts_with_all = ["set", "render"])]
    template: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

/// Lists the templates, or draws one.
///
/// # Errors
/// The template does not exist or is broken, a parameter is outside its range, or the drawing
/// cannot be written.
pub fn fields(args: &FieldsArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let params: BTreeMap<String, f64> = args.set.iter().cloned().collect();
    let Some(name) = &args.name else {
        if args.render.is_some() || !params.is_empty() {
            bail!(
                "--render and --set need the NAME of one template; `touchline fields` lists them"
            );
        }
        let filled = builtin_names()
            .into_iter()
            .map(|name| {
                let template = builtin(name)?;
                Ok((template, template.default_model()?))
            })
            .collect::<anyhow::Result<Vec<_>>>()?;
        list(&filled, messages)?;
        return Ok(Outcome::Done);
    };
    if let Some(path) = &args.template {
        return write_template(name, path, args.force, messages);
    }
    let template = template_named(name, Path::new("."))?;
    // Without a crown: that belongs to a venue, not to a template.
    let field = template.model(&params, 0.0)?;
    match &args.render {
        Some(path) => render(&field, path, args.force)?,
        None => list(&[(&template, field)], messages)?,
    }
    Ok(Outcome::Done)
}

/// Writes the file of a built-in template.
fn write_template(
    name: &str,
    path: &Path,
    force: bool,
    messages: Messages,
) -> anyhow::Result<Outcome> {
    let text = builtin_text(name)?;
    ensure!(
        ending(path) == "json",
        "{}: a template is a file ending in .json",
        path.display()
    );
    refuse_existing_file(path, force)?;
    write_file(path, text.as_bytes(), force)?;
    let file = path.display();
    messages.note(&format!(
        "{file}: the template {name}; change it, and `touchline fields {file} --render field.svg` shows the result"
    ));
    Ok(Outcome::Done)
}

fn list(filled: &[(&Template, FieldModel)], messages: Messages) -> anyhow::Result<()> {
    print(&match messages {
        Messages::Text => filled
            .iter()
            .map(|(template, field)| listing(template, field))
            .collect::<Vec<_>>()
            .join("\n"),
        Messages::Json => {
            let templates: Vec<Value> = filled
                .iter()
                .map(|(template, field)| template_json(template, field))
                .collect();
            format!("{:#}\n", json!({ "templates": templates }))
        }
    })
}

/// A template as text, for people.
fn listing(template: &Template, field: &FieldModel) -> String {
    let mut out = format!("{}  {}\n", template.name, template.title);
    // Writing to a string cannot fail.
    for note in &template.notes {
        let _ = writeln!(out, "  {note}");
    }
    out.push_str("  parameters\n");
    for param in &template.params {
        let value = field
            .params
            .get(&param.name)
            .copied()
            .unwrap_or(param.default);
        let (name, min, max, source) = (
            &param.name,
            metres(param.min),
            metres(param.max),
            &param.source,
        );
        let _ = writeln!(
            out,
            "    {name} = {} ({min} to {max} m; {source})",
            metres(value)
        );
    }
    let _ = writeln!(
        out,
        "  {} landmarks: name, code, x y z in m",
        field.landmarks.len()
    );
    for landmark in &field.landmarks {
        let _ = writeln!(
            out,
            "    {:<44} {:<5} {:>9} {:>9} {:>7}  {}",
            landmark.id.as_str(),
            landmark.code,
            metres(landmark.nominal_m.x),
            metres(landmark.nominal_m.y),
            metres(landmark.nominal_m.z),
            landmark.label
        );
    }
    let _ = writeln!(
        out,
        "  {} lines: name, code, shape, width and edge of the paint",
        field.lines.len()
    );
    for line in &field.lines {
        let shape = shape_name(&line.curve);
        let painted = match line.dash_m {
            _ if !line.painted => ", not painted".to_owned(),
            Some([dash_m, gap_m]) => {
                format!(", dashes {} m, gaps {} m", metres(dash_m), metres(gap_m))
            }
            None => String::new(),
        };
        let _ = writeln!(
            out,
            "    {:<44} {:<5} {shape:<8} {:>5} m {:<6}  {}{painted}",
            line.id.as_str(),
            line.code,
            metres(line.width_m),
            line.edge.name(),
            line.label
        );
    }
    out
}

/// A length rounded to the millimetre, without trailing zeros.
fn metres(value: f64) -> String {
    decimal(value, 3)
}

fn shape_name(curve: &Curve) -> &'static str {
    match curve {
        Curve::Segment { .. } => "segment",
        Curve::Arc { .. } if curve.is_closed() => "circle",
        Curve::Arc { .. } => "arc",
    }
}

/// A template as JSON, for programs.
fn template_json(template: &Template, field: &FieldModel) -> Value {
    let params = template.params.iter().map(|param| {
        let value = json!({
            "label": param.label, "unit": param.unit, "value": field.params.get(&param.name),
            "default": param.default, "min": param.min, "max": param.max, "source": param.source,
        });
        (param.name.clone(), value)
    });
    let dimensions = template.dimensions.iter().map(|dimension| {
        (
            dimension.name.clone(),
            json!({ "value": dimension.value.text(), "source": dimension.source }),
        )
    });
    let landmarks: Vec<Value> = field
        .landmarks
        .iter()
        .map(|landmark| {
            json!({
                "id": landmark.id.as_str(), "label": landmark.label, "code": landmark.code,
                "position_m": triple(landmark.nominal_m), "click_sigma_px": landmark.click_sigma_px,
            })
        })
        .collect();
    json!({
        "name": template.name,
        "title": template.title,
        "notes": template.notes,
        "params": params.collect::<serde_json::Map<_, _>>(),
        "dimensions": dimensions.collect::<serde_json::Map<_, _>>(),
        "extent_m": [field.length_m, field.width_m],
        "symmetry": template.symmetry.iter().map(|symmetry| symmetry.name()).collect::<Vec<_>>(),
        "landmarks": landmarks,
        "lines": field.lines.iter().map(line_json).collect::<Vec<_>>(),
    })
}

fn line_json(line: &FieldLine) -> Value {
    let mut value = json!({
        "id": line.id.as_str(), "label": line.label, "code": line.code, "shape": shape_name(&line.curve),
        "width_m": line.width_m, "edge": line.edge.name(), "painted": line.painted,
        "dash_m": line.dash_m,
    });
    match line.curve {
        Curve::Segment { from, to } => {
            value["from_m"] = json!(triple(from));
            value["to_m"] = json!(triple(to));
        }
        Curve::Arc {
            centre,
            radius_m,
            start,
            sweep,
        } => {
            value["centre_m"] = json!(triple(centre));
            value["radius_m"] = json!(radius_m);
            value["start_deg"] = json!(start.degrees());
            value["sweep_deg"] = json!(sweep.degrees());
        }
    }
    value
}

/// Coordinates, with 0 for −0.
fn triple(point: Vec3) -> [f64; 3] {
    [point.x + 0.0, point.y + 0.0, point.z + 0.0]
}

fn render(field: &FieldModel, path: &Path, force: bool) -> anyhow::Result<()> {
    refuse_existing_file(path, force)?;
    match ending(path).as_str() {
        "svg" => write_file(path, svg(field).as_bytes(), force),
        "png" => write_file(path, &png(field)?, force),
        _ => bail!(
            "--render {}: the name must end with .svg or .png",
            path.display()
        ),
    }
}

/// The field map as the app draws it, as PNG.
fn png(field: &FieldModel) -> anyhow::Result<Vec<u8>> {
    // The longer side of the field, with its margins, gets the width in px.
    let px_per_m = MAP_WIDTH_PX / (field.length_m.max(field.width_m) + 2.0 * MAP_MARGIN_M);
    let map = FieldMap::new(field, MAP_MARGIN_M, px_per_m);
    let size = map.size_px();
    let style = OverlayStyle::default();
    // The window's own drawing, in its two layers: the ground, and what lies over it. Here no
    // picture of a frame lies between them.
    let drawing = field_map(&OverlayScene::new(field, size, &style), &map);
    let layers = [
        Layer::Drawing(Arc::new(drawing.ground)),
        Layer::Drawing(Arc::new(drawing.over)),
    ];
    let drawn = Offscreen::new()?.render(
        &View::one_to_one([size.width, size.height]),
        SURROUND,
        &layers,
    )?;
    encode_png(drawn)
}
