//! The numbers of frames, read from the names of their files.
//!
//! A name may have several runs of digits: `match-720p-000017.json` has 720 and 17. The number of a
//! frame is the run that differs most from name to name; of several such runs the one that counts
//! in ones, because times and other counts beside it go in other steps: `f00017_t000680ms.jpg`,
//! `0017_of_2500.json`. Runs that do so equally are all returned. Runs are counted from the end of a
//! name, because names differ in what stands before the number.

use crate::exchange::files::base_name;
use std::collections::BTreeSet;

/// The most runs of digits that are considered in a name, from its end.
const MAX_RUNS: usize = 12;

/// One number of each name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameNumbers {
    /// By name; none for a name without this number.
    pub numbers: Vec<Option<u64>>,
    /// Which number it is, shown at the first name, where names have others that differ:
    /// `f00017 in f00017_t000680ms.jpg`.
    pub shown_at: Option<String>,
}

/// The numbers in names that may be those of frames, the most plausible first; none for a name that
/// lacks the run that differs.
///
/// None at all where several names have the same digits or no digits. A single name has no other to
/// differ from; its last run counts.
pub fn numbers_in_names(names: &[String]) -> Vec<NameNumbers> {
    let runs: Vec<Vec<Option<u64>>> = names.iter().map(|name| digit_runs(name)).collect();
    let longest = runs.iter().map(Vec::len).max().unwrap_or(0);
    let differing: Vec<usize> = (0..longest)
        .filter(|&run| names.len() == 1 || distinct_numbers(&runs, run) > 1)
        .collect();
    let rank = |run: usize| (distinct_numbers(&runs, run), steps_of_one(&runs, run));
    let best = differing.iter().map(|&run| rank(run)).max();
    let mut best: Vec<usize> = differing
        .iter()
        .copied()
        .filter(|&run| Some(rank(run)) == best)
        .collect();
    // The run that spans least is the number rather than a time, then the last one. `differing`
    // begins with the last run, and the sort is stable.
    best.sort_by_key(|&run| span(&runs, run));
    best.truncate(if names.len() == 1 { 1 } else { MAX_RUNS });
    best.into_iter()
        .map(|run| NameNumbers {
            numbers: column(&runs, run).collect(),
            shown_at: (differing.len() > 1)
                .then(|| text_of_run(names.first()?, run))
                .flatten(),
        })
        .collect()
}

/// A run of a name with the letters before it, and the name.
fn text_of_run(name: &str, run: usize) -> Option<String> {
    let name = base_name(name);
    let stem = without_word_ending(name);
    let mut ends = stem
        .char_indices()
        .filter(|(at, letter)| {
            let next = stem[at + letter.len_utf8()..].chars().next();
            letter.is_ascii_digit() && !next.is_some_and(|next| next.is_ascii_digit())
        })
        .map(|(at, _)| at + 1)
        .rev();
    let whole = &stem[..ends.nth(run)?];
    let before = whole.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let before = before.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
    Some(format!("{} in {name}", &whole[before.len()..]))
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

/// How often a number is one more than that of the name before.
fn steps_of_one(runs: &[Vec<Option<u64>>], run: usize) -> usize {
    let numbers: Vec<Option<u64>> = column(runs, run).collect();
    let is_step =
        |pair: &&[Option<u64>]| pair[0].is_some_and(|first| first.checked_add(1) == pair[1]);
    numbers.windows(2).filter(is_step).count()
}

/// The difference of the largest and the smallest number.
fn span(runs: &[Vec<Option<u64>>], run: usize) -> u64 {
    let numbers: BTreeSet<u64> = column(runs, run).flatten().collect();
    numbers
        .last()
        .zip(numbers.first())
        .map_or(0, |(largest, smallest)| largest - smallest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(names: &[&str]) -> Option<Vec<Option<u64>>> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let best = numbers_in_names(&names).into_iter().next();
        best.map(|best| best.numbers)
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
    fn the_run_that_counts_in_ones_is_taken_and_the_note_names_it() {
        for (name, shown) in [
            (
                (|number| format!("f{number:05}_t{:06}ms.jpg", 40 * number)) as fn(u64) -> String,
                "f00001 in f00001_t000040ms.jpg",
            ),
            (
                |number| format!("{number:04}_of_{}", 2501 - number),
                "0001 in 0001_of_2500",
            ),
            (
                |number| format!("set/t{:06}_{number}.json", 1000 - 40 * number),
                "1 in t000960_1.json",
            ),
        ] {
            let names: Vec<String> = (1..21).map(name).collect();
            let found = numbers_in_names(&names);
            assert_eq!(found.len(), 1, "{names:?}");
            assert_eq!(found[0].numbers, (1..21).map(Some).collect::<Vec<_>>());
            assert_eq!(found[0].shown_at.as_deref(), Some(shown));
        }
    }

    #[test]
    fn where_two_runs_count_alike_both_are_candidates() {
        let names: Vec<String> = (0..9)
            .map(|number| format!("{}_{number}", 100 + number))
            .collect();
        let found = numbers_in_names(&names);
        let firsts: Vec<_> = found.iter().map(|found| found.numbers[0]).collect();
        assert_eq!(firsts, [Some(0), Some(100)], "the last run first");
        let sampled: Vec<String> = (0..9)
            .map(|step| format!("{}_{}", 5 * step, 200 * step))
            .collect();
        let found = numbers_in_names(&sampled);
        assert_eq!(found[0].numbers[1], Some(5));
        assert_eq!(found[1].numbers[1], Some(200));
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
