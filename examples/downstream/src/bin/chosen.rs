//! Impact of a disk on a wall: `chosen METHOD LAW [STEPS]`, with method and law by name.

use downstream::choose::{self, Failure, LAWS, METHODS};

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [method, law] = [0, 1].map(|n| words.get(n).map(String::as_str));
    let (Some(method), Some(law)) = (method, law) else {
        println!(
            "chosen METHOD LAW [STEPS]\n\nmethods: {}\nlaws:    {}",
            METHODS.join(", "),
            LAWS.join(", ")
        );
        return Ok(());
    };
    let steps: u64 = words.get(2).map_or(Ok(200), |n| n.parse())?;
    let mut mpm = choose::scene(choose::method(method)?, choose::law(law)?)?;
    let before = mpm.totals();
    for _ in 0..steps {
        mpm.step()?;
    }
    let after = mpm.totals();
    println!("{}", mpm.facts().description);
    println!(
        "{} particles, {steps} steps, t = {:.3e} s: kinetic energy {:.3e} of {:.3e} J, internal {:.3e} J; particles {:016x}",
        mpm.particles(),
        mpm.time(),
        after.kinetic,
        before.kinetic,
        after.internal - before.internal,
        choose::fingerprint(&mpm)
    );
    Ok(())
}
