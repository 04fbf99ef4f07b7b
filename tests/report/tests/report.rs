//! What the page is put together by.

use report::job::Job;
use report::limits::{self, Asked};
use report::pool::each;
use report::price::{Need, needed};
use report::sweep::{charts, jobs};
use verification::{Kernel, Scheme, Velocity};

#[test]
fn every_item_is_done_once_and_an_error_stops() {
    let items: Vec<usize> = (0..100).collect();
    let mut seen = Vec::new();
    let made: Result<(), ()> = each(
        3,
        &items,
        |n| n * n,
        |count, n, square| {
            seen.push((count, *n, square));
            Ok(())
        },
    );
    assert!(made.is_ok());
    assert!(seen.iter().enumerate().all(|(at, s)| s.0 == at + 1 && s.2 == s.1 * s.1));
    seen.sort_by_key(|s| s.1);
    assert_eq!(seen.iter().map(|s| s.1).collect::<Vec<_>>(), items);
    let made = each(2, &items, |n| *n, |count, _, _| if count == 5 { Err("five") } else { Ok(()) });
    assert_eq!(made, Err("five"));
}

#[test]
fn a_power_law_is_met_exactly() {
    // Error 1 / cost.
    let series: Vec<_> = [10.0, 40.0, 160.0].map(|c: f64| (Some(c), Some(1.0 / c))).into();
    let Need::Is(found) = needed(&series, 0.01) else { panic!("{:?}", needed(&series, 0.01)) };
    assert!((found - 100.0).abs() < 1e-9, "{found}");
    assert_eq!(needed(&series, 0.5), Need::AtMost(10.0));
    assert_eq!(needed(&series, 1e-3), Need::Unreachable);
    // Small by luck on the coarse grid.
    assert_eq!(needed(&[(Some(1.0), Some(0.001)), (Some(4.0), Some(0.1))], 0.01), Need::Unreachable);
    // A run that stopped brackets nothing.
    assert_eq!(needed(&[(Some(1.0), None), (Some(4.0), Some(0.001))], 0.01), Need::AtMost(4.0));
    assert_eq!(needed(&[(None, Some(0.1)), (None, Some(0.001))], 0.01), Need::Unknown);
}

/// What is written down of a run leads back to it: else a sweep would never be done.
#[test]
fn names_lead_back_to_jobs() {
    for chart in charts() {
        for quick in [true, false] {
            let list = jobs(chart.problem, quick);
            assert!(!list.is_empty(), "{}: nothing to run", chart.id);
            for job in list {
                let key = job.key();
                assert_eq!(key.problem, chart.problem);
                let found = Job::of(&key).unwrap_or_else(|| panic!("{key:?} leads nowhere"));
                assert_eq!(found.key(), key);
                let scaled = job.scaled().key();
                assert_eq!((scaled.scheme, scaled.per_axis), (key.scheme, key.per_axis));
            }
        }
    }
}

/// Every limit of the chart is found again by what was asked; the least steps are those that theory has.
#[test]
fn limits_are_found_and_drawn() {
    let asked = Asked::all(true);
    let of = |kernel, velocity| {
        let scheme = Scheme::moving(kernel, velocity);
        asked.iter().filter(move |a| a.scheme == scheme && a.per_cell == 2)
    };
    let mut list = Vec::new();
    for asked in
        of(Kernel::Quadratic, Velocity::FlipMusl).chain(of(Kernel::Quadratic, Velocity::ApicUsl)).step_by(8)
    {
        let found = asked.make("none").unwrap();
        assert!(found.is_of(asked));
        assert!((found.measured / found.predicted - 1.0).abs() < 0.1, "{found:?}");
        list.push(found);
    }
    assert_eq!(list.len(), 4);
    let mut page = String::new();
    limits::section(&mut page, &list);
    assert_eq!(page.matches("<figure>").count(), 1);
    // Two lines each of two transfers, in the drawing; markers there and in the legend.
    assert_eq!(page.matches("class=\"disc").count(), 4 + 3);
    assert!(page.contains("Of 4 arrangements"), "{page}");
}
