//! The numbers of frames, read from the names of their files.
//!
//! A name may have several runs of digits: `match-720p-000017.json` has 720 and 17. The number of a
//! frame is the run that differs most from name to name; of several such runs the last one. Runs
//! are counted from the end of a name, because names differ in what stands before the number.

use std::cmp::Reverse;
use std::collections::BTreeSet;

/// The most runs of digits that are considered in a name, from its end.
const MAX_RUNS: usize = 12;

/// The number in each name; none for a name that lacks the run that differs.
///
/// None at all where several names have the same digits or no digits. A single name has no other to
/// differ from; its last run counts.
pub fn numbers_in_names(names: &[String]) -> Option<Vec<Option<u64>>> {
    let runs: Vec<Vec<Option<u64>>> = names.iter().map(|name| digit_runs(name)).collect();
    let longest = runs.iter().map(Vec::len).max().unwrap_or(0);
    // Of equally many numbers the last run counts: `Reverse` makes the smallest index from the end
    // the largest key.
    let best = (0..longest).max_by_key(|&run| (distinct_numbers(&runs, run), Reverse(run)))?;
    let differs = distinct_numbers(&runs, best) > 1;
    (differs || names.len() == 1).then(|| column(&runs, best).collect())
}

/// The runs of digits of a name without its ending, last first; none for one of too many digits.
fn digit_runs(name: &str) -> Vec<Option<u64>> {
    without_word_ending(name)
        .rsplit(|letter: char| !letter.is_ascii_digit())
        .filter(|run| !run.is_empty())
        .take(MAX_RUNS)
        .map(|run| run.parse().ok())
        .collect()
}

/// A name without a file's ending. An ending of digits alone belongs to the name: `frame.000017`.
pub fn without_word_ending(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((stem, ending)) if is_word(ending) => stem,
        _ => name,
    }
}

/// Whether an ending is that of a file, such as `json` or `mp4`.
fn is_word(ending: &str) -> bool {
    ending.contains(|letter: char| letter.is_ascii_alphabetic())
        && ending
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
}

/// The run of each name at a position from the end.
fn column(runs: &[Vec<Option<u64>>], run: usize) -> impl Iterator<Item = Option<u64>> + '_ {
    runs.iter()
        .map(move |of_name| of_name.get(run).copied().flatten())
}

fn distinct_numbers(runs: &[Vec<Option<u64>>], run: usize) -> usize {
    column(runs, run).flatten().collect::<BTreeSet<u64>>().len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(names: &[&str]) -> Option<Vec<Option<u64>>> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        numbers_in_names(&names)
    }

    #[test]
    fn the_run_that_differs_is_the_number() {
        for names in [
            ["camera_match_000017.json", "camera_match_000018.json"],
            ["000017", "000018"],
            ["frame_17", "frame_18"],
            ["17.json", "18.json"],
            ["match-00017.png", "match-00018.png"],
            ["match_720p_17.jpg", "match_720p_18.jpg"],
            ["17_720p.jpg", "18_720p.jpg"],
            ["frame.000017", "frame.000018"],
            ["000017/camera1.json", "000018/camera1.json"],
            ["17_v2.json", "18_v2.json"],
        ] {
            assert_eq!(numbers(&names), Some(vec![Some(17), Some(18)]), "{names:?}");
        }
    }

    #[test]
    fn the_run_that_differs_most_is_taken_before_one_that_repeats() {
        let names = ["17_t0.680", "18_t0.720", "19_t0.760", "20_t0.680"];
        let found = [17, 18, 19, 20].map(Some);
        assert_eq!(numbers(&names), Some(found.to_vec()));
    }

    #[test]
    fn names_without_numbers_have_none() {
        assert_eq!(numbers(&["a.json", "b.json"]), None);
        assert_eq!(numbers(&["720p_a.json", "720p_b.json"]), None);
        assert_eq!(numbers(&[]), None);
        assert_eq!(
            numbers(&["a_1", "a_2", "other"]),
            Some(vec![Some(1), Some(2), None])
        );
        assert_eq!(numbers(&["match_720p_17.json"]), Some(vec![Some(17)]));
        let too_long = "9".repeat(40);
        assert_eq!(
            numbers(&["1", "2", &too_long]),
            Some(vec![Some(1), Some(2), None])
        );
    }
}
