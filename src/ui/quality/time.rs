//! Tick marks of a time axis, at numbers in which people count: whole frames, or steps of a clock.

use touchline_application::app::quality::TimeAxis;
use touchline_documents::report::figure::Ruler;

/// About `wanted` tick marks within `span`, each with its label. Positions are in the unit of the
/// axis: frame numbers or s.
pub fn time_ticks(axis: TimeAxis, span: [f64; 2], wanted: f64) -> Vec<(f64, String)> {
    /// Steps of a clock, s.
    const CLOCK_S: [f64; 13] = [
        1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0,
    ];
    let ruler = || Ruler::within(span, wanted).ticks;
    match axis {
        TimeAxis::Frame => {
            let whole = ruler()
                .into_iter()
                .map(|(at, _)| at)
                .filter(|at| (at - at.round()).abs() < 1e-9);
            whole.map(|at| (at, format!("{at:.0}"))).collect()
        }
        // Less than a second for each tick: decimal steps, labelled in seconds.
        TimeAxis::Video if (span[1] - span[0]) / wanted < 1.0 => ruler()
            .into_iter()
            .map(|(at, words)| (at, format!("{words} s")))
            .collect(),
        // The smallest step of a clock, or multiple of an hour, that gives at most `wanted` ticks.
        TimeAxis::Video => {
            let rough = (span[1] - span[0]) / wanted;
            let step = CLOCK_S
                .into_iter()
                .find(|step| *step >= rough)
                .unwrap_or(3600.0 * (rough / 3600.0).ceil());
            let from = (span[0] / step).ceil() as i64;
            let upto = (span[1] / step).floor() as i64;
            (from..=upto)
                .map(|count| count as f64 * step)
                .map(|at| (at, clock(at)))
                .collect()
        }
    }
}

/// Seconds as minutes and seconds, `m:ss`.
fn clock(at_s: f64) -> String {
    let whole = at_s.round() as i64;
    format!("{}:{:02}", whole / 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn describe(axis: TimeAxis, span: [f64; 2]) -> Vec<String> {
        time_ticks(axis, span, 4.0)
            .into_iter()
            .map(|(_, words)| words)
            .collect()
    }

    #[test]
    fn time_has_numbers_that_a_person_counts_in() {
        assert_eq!(
            describe(TimeAxis::Frame, [1.0, 812.0]),
            ["200", "400", "600", "800"]
        );
        assert_eq!(describe(TimeAxis::Frame, [3.0, 4.0]), ["3", "4"]);
        assert_eq!(
            describe(TimeAxis::Video, [0.0, 100.0]),
            ["0:00", "0:30", "1:00", "1:30"]
        );
        assert_eq!(
            describe(TimeAxis::Video, [3599.0, 9000.0]),
            ["60:00", "90:00", "120:00", "150:00"]
        );
        assert_eq!(
            describe(TimeAxis::Video, [1.0, 2.0]),
            ["1.0 s", "1.2 s", "1.4 s", "1.6 s", "1.8 s", "2.0 s"]
        );
    }
}
