//! Files of samples in JSON, however they are laid out: one sample, a list of them, or one a line.

use super::node::parse;
use crate::exchange::error::Problem;
use crate::exchange::files::text;
use serde_json::Value;

/// The samples of a file with their lines: one sample, a list of them, or one a line.
///
/// # Errors
/// The file is empty or no text, or `each` fails.
pub fn each_sample(
    bytes: &[u8],
    mut each: impl FnMut(Option<usize>, Result<Value, Problem>) -> Result<(), Problem>,
) -> Result<(), Problem> {
    let text = text(bytes)?;
    let lines = text.lines().enumerate();
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty()).peekable();
    // A file of one sample a line is never read as a whole: it may be as long as a match. The first
    // line of any other file is no JSON by itself, or a list.
    let first = lines.peek().map_or("", |(_, line)| *line);
    let is_sample_a_line = matches!(parse(first.as_bytes()), Ok(Value::Object(_)));
    if !is_sample_a_line {
        match parse(bytes) {
            Ok(Value::Array(samples)) => {
                return samples
                    .into_iter()
                    .try_for_each(|sample| each(None, Ok(sample)));
            }
            Ok(sample) => return each(None, Ok(sample)),
            // A damaged line among others, unless the file is one damaged sample.
            Err(problem) if first.trim() == "{" || first.trim_start().starts_with('[') => {
                return each(None, Err(problem));
            }
            Err(_) => {}
        }
    }
    for (index, line) in lines {
        each(Some(index + 1), parse(line.as_bytes()))?;
    }
    Ok(())
}
