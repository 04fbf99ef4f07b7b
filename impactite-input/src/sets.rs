//! Properties of named sets of constants, from the laws themselves.

use impactite::materials::Material;

use crate::build::material::Described;

impl Described {
    /// Return density, wave speed, moduli and yield stress; the parts of the law with their constants; the failure.
    pub(crate) fn properties(&self) -> Vec<String> {
        let law: &dyn Material<f64> = &*self.law;
        let text = law.constants();
        let parsed = Parser { rest: &text }.node();
        let density = law.density();
        let mut first = vec![format!("density {} kg/m^3", short(density))];
        let shear = parsed.find("shear").filter(|g| g.is_finite());
        if let Some(speed) = law.step_speed(&law.virgin(), 1.0) {
            first.push(format!("wave speed {} m/s", short(speed)));
            let modulus = density * speed * speed - 4.0 / 3.0 * shear.unwrap_or(0.0);
            first.push(format!("bulk modulus {} GPa", short(1e-9 * modulus)));
        }
        if let Some(shear) = shear {
            first.push(format!("shear modulus {} GPa", short(1e-9 * shear)));
        }
        if let Some(initial) = parsed.find("initial") {
            first.push(format!("initial yield stress {} MPa", short(1e-6 * initial)));
        }
        let mut lines = vec![first.join(", ")];
        match &parsed {
            Node::Table(name, fields) if fields.iter().any(|(_, node)| node.is_table()) => {
                let ingredients = fields.iter().filter(|(_, node)| node.is_table());
                lines.extend(ingredients.map(|(key, node)| format!("{key} {node}")));
                let single: Vec<String> = fields
                    .iter()
                    .filter(|(key, node)| !node.is_table() && node.is_told(key))
                    .map(|(key, node)| format!("{key} {node}"))
                    .collect();
                if !single.is_empty() {
                    lines.push(format!("{name}: {}", single.join(", ")));
                }
            }
            whole => lines.push(whole.to_string()),
        }
        lines.push(format!("failure: {}", self.failure));
        lines
    }
}

/// Value parsed from `Debug` output.
#[derive(Debug, PartialEq)]
enum Node {
    Table(String, Vec<(String, Node)>),
    List(Vec<Node>),
    Number(f64),
    Word(String),
}

impl Node {
    fn is_table(&self) -> bool {
        matches!(self, Node::Table(..))
    }
    /// True for a constant of the source; false for an absent part or a derived number.
    fn is_told(&self, key: &str) -> bool {
        let derived = ["beyond", "chord", "locked", "compression_burn", "delay", "localisation"];
        let absent =
            ["NoFailure", "NoViscosity", "HughesWinget", "Inviscid", "RateIndependent", "Isothermal"];
        !derived.contains(&key) && !matches!(self, Node::Word(word) if absent.contains(&word.as_str()))
    }
    /// Return the first number with this name.
    fn find(&self, name: &str) -> Option<f64> {
        let Node::Table(_, fields) = self else { return None };
        fields.iter().find_map(|(key, node)| match node {
            Node::Number(x) if key == name => Some(*x),
            inner => inner.find(name),
        })
    }
}

impl std::fmt::Display for Node {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Node::Table(name, fields) => {
                let told = fields.iter().filter(|(key, node)| node.is_told(key));
                let list: Vec<String> = told.map(|(key, node)| format!("{key} {node}")).collect();
                write!(f, "{name} ({})", list.join(", "))
            }
            Node::List(list) => {
                let list: Vec<String> = list.iter().map(Node::to_string).collect();
                write!(f, "[{}]", list.join(", "))
            }
            Node::Number(x) => write!(f, "{}", short(*x)),
            Node::Word(word) => write!(f, "{word}"),
        }
    }
}

/// Format a number with at most five digits.
fn short(x: f64) -> String {
    let size = x.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        let text = format!("{x:.4e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", trimmed(digits));
    }
    let digits = if size >= 1.0 { 4 - (size.log10().floor() as usize).min(4) } else { 5 };
    trimmed(&format!("{x:.digits$}")).into()
}

fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// Parser of `Debug` output of structs, arrays, numbers and words.
struct Parser<'a> {
    rest: &'a str,
}

impl Parser<'_> {
    fn skip(&mut self, what: &str) -> bool {
        let trimmed = self.rest.trim_start();
        match trimmed.strip_prefix(what) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }
    fn word(&mut self) -> String {
        let start = self.rest.trim_start();
        let end = start.find(|c: char| " ,:{}[]()".contains(c)).unwrap_or(start.len());
        let (word, rest) = start.split_at(end);
        self.rest = rest;
        word.into()
    }
    fn node(&mut self) -> Node {
        if self.skip("[") {
            let mut list = Vec::new();
            while !self.rest.is_empty() && !self.skip("]") {
                list.push(self.node());
                self.skip(",");
            }
            return Node::List(list);
        }
        let word = self.word();
        if self.skip("{") {
            let mut fields = Vec::new();
            while !self.rest.trim_start().is_empty() && !self.skip("}") {
                let key = self.word();
                if !self.skip(":") {
                    // Unknown syntax: stop parsing.
                    self.rest = "";
                    break;
                }
                fields.push((key, self.node()));
                self.skip(",");
            }
            return Node::Table(word, fields);
        }
        match word.parse() {
            Ok(number) => Node::Number(number),
            Err(_) => Node::Word(word),
        }
    }
}
