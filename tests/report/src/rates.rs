//! Throughput chart: particle-steps per second against particles.

use std::fmt::Write;
use std::io;
use std::path::Path;

use examples::peers::Peer;

use crate::chart::{Mark, Scale, axes, escape, open, percent};
use crate::speed::{Asked, KERNELS, Speed};

/// Write all speeds as a CSV table.
pub fn write_csv(path: &Path, speeds: &[Speed]) -> io::Result<()> {
    let mut text = String::from(
        "program,kernel,bits,particles,threads,steps,particle-steps a second (best),of repeats,bytes a particle,commit\n",
    );
    for s in speeds {
        let rates: Vec<String> = s.rates.iter().map(|r| format!("{r:.4e}")).collect();
        text.push_str(&format!(
            "{},{},{},{},{},{},{:.4e},{},{:.0},{}\n",
            s.asked.peer.map_or("Impactite", Peer::name),
            s.asked.kernel,
            s.asked.bits,
            s.count,
            s.asked.threads,
            s.steps,
            s.best(),
            rates.join(" "),
            s.bytes,
            s.commit
        ));
    }
    std::fs::write(path, text)
}

/// Line of the chart: program, kernel, precision and number of threads, over sizes.
struct Line<'a> {
    name: String,
    colour: usize,
    dash: &'static str,
    mark: Mark,
    own: Vec<&'a Speed>,
}

/// List the lines of this library, then those of peers.
fn lines(speeds: &[Speed], threads: usize) -> Vec<Line<'_>> {
    let mut list = Vec::new();
    for peer in [None].into_iter().chain(Peer::ALL.map(Some)) {
        for (colour, kernel) in KERNELS.into_iter().enumerate() {
            for bits in [64, 32] {
                let is_own = |s: &&Speed| {
                    let asked = &s.asked;
                    (asked.peer, asked.kernel.as_str(), asked.bits, asked.threads)
                        == (peer, kernel, bits, threads)
                };
                let mut own: Vec<&Speed> = speeds.iter().filter(is_own).collect();
                own.sort_by_key(|s| s.count);
                let Some(first) = own.first() else { continue };
                let dash = match (peer, bits) {
                    (Some(_), _) => "2 4",
                    (None, 32) => "7 4",
                    _ => "none",
                };
                let (name, mark) = (first.asked.name(), Mark::of(peer, bits == 32));
                list.push(Line { name, colour: 2 * colour + 1, dash, mark, own });
            }
        }
    }
    list
}

fn drawing(speeds: &[Speed], threads: usize) -> Option<String> {
    let x = Scale::across(speeds.iter().map(|s| s.count as f64))?;
    let y = Scale::up(speeds.iter().map(|s| s.best()))?;
    let plural = if threads == 1 { "thread" } else { "threads" };
    let title = format!("{threads} {plural}; best of repeats, whiskers: worst");
    let mut out = open(&title);
    axes(&mut out, (&x, &y), "particles", "particle-steps a second", &title);
    for Line { name, colour, dash, mark, own } in lines(speeds, threads) {
        let mut d = String::new();
        for s in &own {
            let (at, high) = (x.at(s.count as f64), y.at(s.best()));
            let _ = write!(d, "{}{at:.1} {high:.1}", if d.is_empty() { "M" } else { "L" });
            let worst = s.rates.iter().copied().fold(f64::INFINITY, f64::min);
            let _ =
                write!(out, "<path class=\"line c{colour}\" d=\"M{at:.1} {high:.1}V{:.1}\"/>", y.at(worst));
        }
        let _ = write!(out, "<path class=\"line c{colour}\" stroke-dasharray=\"{dash}\" d=\"{d}\"/>");
        for s in own {
            let (at, high) = (x.at(s.count as f64), y.at(s.best()));
            let tip = format!("{name}: {} particles, {:.1} million/s", s.count, 1e-6 * s.best());
            mark.draw(&mut out, colour, (at, high), 4.0, &escape(&tip));
        }
    }
    out.push_str("</svg>");
    Some(out)
}

/// Write the section of the page.
pub fn section(out: &mut String, speeds: &[Speed]) {
    out.push_str(
        "<section><h2 id=\"c12-throughput\">C12. Throughput</h2><p>Particle-steps a second, whole steps with all migration of particles, \
         by the scenes of <code>throughput</code>: a cube in a smooth field of velocity, and a copper cylinder on a wall \
         (Johnson-Cook). By the clock, so that other load of the machine is in it. Discs and whole lines: double precision; rings and \
         dashes: single. Up is better.</p>",
    );
    let mut threads: Vec<usize> = speeds.iter().map(|s| s.asked.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    if threads.is_empty() {
        out.push_str("<p>No run yet.</p></section>");
        return;
    }
    out.push_str("<div class=\"pair\">");
    for &n in &threads {
        let _ = write!(out, "<figure>{}</figure>", drawing(speeds, n).unwrap_or_default());
    }
    out.push_str("</div><p class=\"legend\">");
    for Line { name, colour, dash, mark, .. } in lines(speeds, threads[0]) {
        let _ = write!(
            out,
            "<span><svg viewBox=\"0 0 34 12\"><path class=\"line c{colour}\" stroke-dasharray=\"{dash}\" d=\"M0 6H34\"/>"
        );
        mark.draw(out, colour, (17.0, 6.0), 4.0, "");
        let _ = write!(out, "</svg>{}</span> ", escape(&name));
    }
    out.push_str("</p>");
    reading(out, speeds, &threads);
    against(out, speeds, &threads);
    table(out, speeds);
    out.push_str(
        "<p><small>Data: <a href=\"c12-throughput.csv\">c12-throughput.csv</a>.</small></p></section>",
    );
}

/// Best rate of a line.
fn peak<'a>(own: &[&'a Speed]) -> Option<&'a Speed> {
    own.iter().copied().max_by(|a, b| a.best().total_cmp(&b.best()))
}

/// Speeds of this library.
fn ours(speeds: &[Speed]) -> impl Iterator<Item = &Speed> {
    speeds.iter().filter(|s| s.asked.peer.is_none())
}

/// Find the speed of a request with as many particles as `like`.
fn find<'a>(speeds: &'a [Speed], like: &Speed, asked: &Asked) -> Option<&'a Speed> {
    speeds.iter().find(|s| s.asked == *asked && s.count == like.count)
}

/// Describe the ratio of this library's speeds to those of peers.
fn against(out: &mut String, speeds: &[Speed], threads: &[usize]) {
    if speeds.iter().all(|s| s.asked.peer.is_none()) {
        return;
    }
    out.push_str(
        "<p><b>Peers.</b> Squares and diamonds are programs of ours for Taichi and Warp (<code>benchmarks/peers</code>) on the same cube, \
         double precision, in a dense box of nodes; they start anew after 100 steps, so that it need not be large. ",
    );
    for &n in threads {
        for Line { name, own, .. } in lines(speeds, n).into_iter().filter(|l| l.own[0].asked.peer.is_some()) {
            let ratio = |s: &&Speed| {
                let twin = find(speeds, s, &Asked { peer: None, ..s.asked.clone() })?;
                Some(twin.best() / s.best())
            };
            let known: Vec<f64> = own.iter().filter_map(ratio).collect();
            let low = known.iter().copied().reduce(f64::min);
            let high = known.iter().copied().reduce(f64::max);
            let (Some(low), Some(high)) = (low, high) else { continue };
            let plural = if n == 1 { "thread" } else { "threads" };
            let _ =
                write!(out, "{n} {plural}, {}: ours is {low:.1} to {high:.1} times as fast. ", escape(&name));
        }
    }
    let of_peers = speeds.iter().filter(|s| s.asked.peer.is_some());
    if let Some(band) = of_peers.filter_map(Speed::band).reduce(f64::max) {
        let _ = write!(out, "The same run of a peer made again differs by up to {}. ", percent(band));
    }
    out.push_str("They neither sort particles nor keep books nor check for failures; with few particles their launches of kernels weigh most.</p>");
}

fn reading(out: &mut String, speeds: &[Speed], threads: &[usize]) {
    out.push_str("<p><b>Reading.</b> ");
    for Line { name, own, .. } in lines(speeds, threads[0]) {
        let (Some(best), Some(largest)) = (peak(&own), own.last()) else { continue };
        let _ = write!(
            out,
            "{name}: {:.1} million a second at most (at {} particles), {:.1} at {}. ",
            1e-6 * best.best(),
            best.count,
            1e-6 * largest.best(),
            largest.count
        );
    }
    if let [one, .., more] = threads {
        let gain = |s: &&Speed| {
            let twin = find(speeds, s, &Asked { threads: *more, ..s.asked.clone() });
            twin.map(|t| (s.count, t.best() / s.best()))
        };
        let gains: Vec<(u64, f64)> =
            ours(speeds).filter(|s| s.asked.threads == *one).filter_map(|s| gain(&s)).collect();
        let most = gains.iter().map(|g| g.0).max().unwrap_or_default();
        let large: Vec<f64> = gains.iter().filter(|g| 2 * g.0 > most).map(|g| g.1).collect();
        if let (Some(low), Some(high)) =
            (large.iter().copied().reduce(f64::min), large.iter().copied().reduce(f64::max))
        {
            let _ = write!(
                out,
                "With the most particles {more} threads bring {low:.2} to {high:.2} times the rate of {one}. "
            );
        }
    }
    if let Some(band) = ours(speeds).filter_map(Speed::band).reduce(f64::max) {
        let _ = write!(
            out,
            "The same run made again differs by up to {} here: smaller differences mean nothing.",
            percent(band)
        );
    }
    out.push_str("</p>");
}

fn table(out: &mut String, speeds: &[Speed]) {
    out.push_str(
        "<details><summary>All rates</summary><div class=\"wide\"><table><tr><th>program</th><th>kernel</th><th>bits</th><th>threads</th>\
         <th>particles</th><th>million particle-steps a second: repeats</th><th>bytes a particle</th></tr>",
    );
    for s in speeds {
        let rates: Vec<String> = s.rates.iter().map(|r| format!("{:.2}", 1e-6 * r)).collect();
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.0}</td></tr>",
            s.asked.peer.map_or("Impactite", Peer::name),
            escape(&s.asked.kernel),
            s.asked.bits,
            s.asked.threads,
            s.count,
            rates.join(", "),
            s.bytes
        );
    }
    out.push_str("</table></div></details>");
}
