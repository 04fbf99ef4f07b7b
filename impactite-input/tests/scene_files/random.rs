//! Random scenes of the names of the reference of keys: each runs, or is refused with the key.

use impactite_input::keys::{self, Key};
use impactite_input::list::Topic;
use impactite_input::{InputError, Source};
use serde_json::{Map, Value, json};

/// Number of scenes.
const SCENES: u64 = 300;

struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
    fn one<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
    fn chance(&mut self, one_in: usize) -> bool {
        self.below(one_in) == 0
    }
}

/// Add `from` to `to`, table by table.
fn merge(to: &mut Map<String, Value>, from: &Map<String, Value>) {
    for (key, value) in from {
        match (to.get_mut(key), value) {
            (Some(Value::Object(to)), Value::Object(from)) => merge(to, from),
            _ => {
                to.insert(key.clone(), value.clone());
            }
        }
    }
}

/// Examples of the reference.
struct Catalogue(Vec<Key>);

impl Catalogue {
    /// Names directly below a key of a material.
    fn below(&self, above: &str) -> Vec<&Key> {
        let above = format!("materials.NAME.{above}.");
        self.0
            .iter()
            .filter(|k| k.path.strip_prefix(&above).is_some_and(|name| !name.contains('.')))
            .collect()
    }
    /// Random one of the names directly below a key of a material.
    fn any(&self, random: &mut Random, above: &str) -> &Key {
        let list = self.below(above);
        list[random.below(list.len())]
    }
    fn key(&self, path: &str) -> &Key {
        self.0.iter().find(|key| key.path == path).unwrap_or_else(|| panic!("no key {path}"))
    }
    /// Keys of a material in the example of a key.
    fn of(key: &Key) -> &Map<String, Value> {
        key.scene["materials"]["steel"].as_object().unwrap_or_else(|| panic!("{}: {}", key.path, key.scene))
    }
    fn material(&self, random: &mut Random) -> Map<String, Value> {
        let mut made = Map::new();
        let add = |made: &mut Map<String, Value>, key: &Key| merge(made, Self::of(key));
        match random.below(12) {
            0..=5 => {
                add(&mut made, self.any(random, "strength"));
                add(&mut made, self.any(random, "eos"));
                for _ in 0..random.below(4) {
                    let criterion = self.any(random, "failure");
                    if !criterion.path.ends_with(".library") {
                        add(&mut made, criterion);
                    }
                }
                if random.chance(6) {
                    add(&mut made, self.key("materials.NAME.porous"));
                }
            }
            6 | 7 => {
                let sets = &self.key("materials.NAME.library").words;
                made.insert("library".into(), json!(random.one(sets).0));
                if random.chance(4) {
                    made.insert("failure".into(), json!("library"));
                }
            }
            8 => add(&mut made, self.any(random, "ground")),
            9 => {
                add(&mut made, self.any(random, "fluid"));
                if random.chance(3) {
                    add(&mut made, self.key("materials.NAME.bingham"));
                }
            }
            10 => add(&mut made, self.any(random, "explosive")),
            _ => add(
                &mut made,
                self.key(if random.chance(2) {
                    "materials.NAME.elastic"
                } else {
                    "materials.NAME.neo_hookean"
                }),
            ),
        }
        if random.chance(3) {
            made.insert("bulk_viscosity".into(), json!([0.06, 1.5]));
        }
        made
    }
}

fn names(topic: Topic, group: &str) -> Vec<String> {
    topic.lines().into_iter().filter(|line| line.group == group).map(|line| line.name).collect()
}

/// Build a random scene of two bodies that meet.
fn scene(catalogue: &Catalogue, random: &mut Random) -> Value {
    let spaces = ["3d", "plane strain", "plane stress", "axisymmetric"];
    let space = *random.one(&spaces);
    let methods = [
        json!({ "mpm": { "cell": "1 mm", "for": *random.one(&["impact", "contact at rest", "machine parts", "large elastic"]) } }),
        json!({ "mpm": { "cell": "1 mm" } }),
        json!({ "fem": {} }),
        json!({ "sph": { "spacing": "1 mm" } }),
        json!({ "fpm": { "spacing": "1 mm" } }),
        json!({ "pcmm": { "spacing": "1 mm" } }),
    ];
    let method = random.one(&methods).clone();
    let (corners, velocity): (fn(f64) -> Value, Value) = if space == "3d" {
        (|z| json!({ "from": [0, 0, z], "to": [3e-3, 3e-3, z + 3e-3] }), json!([0, 0, "-20 m/s"]))
    } else {
        (|z| json!({ "from": [0, z], "to": [3e-3, z + 3e-3] }), json!([0, "-20 m/s"]))
    };
    let body = |material: &str, place: f64| {
        let mut body = json!({ "material": material, "shape": { "box": corners(place) } });
        if method.get("fem").is_some() {
            body["mesh"] = json!({ "edge": "1 mm" });
        }
        body
    };
    let (one, mut other) = (body("one", 0.0), body("other", 3.2e-3));
    other["velocity"] = velocity;
    if random.chance(8) {
        other["split_at"] = json!(1.5);
    }
    let laws = names(Topic::Contacts, "contact.law");
    let law = random.one(&laws).clone();
    let example = catalogue.key(&format!("contact.law.{law}")).scene["contact"]["law"].clone();
    let mut contact = json!({ "law": example });
    if random.chance(2) {
        contact["detector"] = json!(random.one(&names(Topic::Contacts, "contact.detector")));
    }
    json!({
        "title": "random", "space": space, "end": "1 ms", "method": method, "contact": contact,
        "materials": { "one": catalogue.material(random), "other": catalogue.material(random) },
        "bodies": { "one": one, "other": other },
    })
}

#[test]
fn random_scenes_of_all_names_run_or_are_refused_with_the_key() {
    let catalogue = Catalogue(keys::all());
    let (mut run, mut refused, mut stopped) = (0, 0, 0);
    for seed in 0..SCENES {
        let scene = scene(&catalogue, &mut Random(seed * 7919 + 1));
        let source = Source::from_json(format!("{seed}"), &scene.to_string()).expect("JSON");
        let file = source.parse().unwrap_or_else(|e| panic!("{seed}: {e}\n{scene}"));
        match source.build(&file) {
            Ok(mut solver) => {
                let done = (0..3).try_for_each(|_| solver.step_at_most(1e-3).map(|_| ()));
                let energy = solver.totals().kinetic;
                assert!(energy.is_finite(), "{seed}: {energy}\n{scene}");
                match done {
                    Ok(()) => run += 1,
                    Err(_) => stopped += 1,
                }
            }
            Err(InputError::At(fault)) => {
                let roots = ["materials.", "bodies", "contact", "method.", "space"];
                assert!(roots.iter().any(|root| fault.key.starts_with(root)), "{seed}: {fault}\n{scene}");
                println!("{seed}: {}: {}", fault.key, fault.message);
                refused += 1;
            }
            Err(other) => panic!("{seed}: {other}\n{scene}"),
        }
    }
    println!("{run} run, {refused} are refused, {stopped} stop");
    assert!(run > SCENES / 5, "{run} of {SCENES} run");
    assert!(stopped < SCENES / 20, "{stopped} of {SCENES} stop in three steps");
}
