//! Arithmetic expressions of variables, compiled to a list of operations on a stack.
//!
//! Precedence is that of mathematics: powers first, from right to left and before a sign (`-x^2` is -(x^2), `2^3^2` is 2^9, `2^-1` is 0.5),
//! then products and quotients, then sums and differences, both from left to right.

use std::f64::consts::{E, PI, TAU};

/// Maximum number of values on the stack during an evaluation.
const STACK: usize = 64;

/// Expression of variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    operations: Vec<Operation>,
    /// Names of the variables, in the order of their first appearance.
    names: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    Number(f64),
    Variable(usize),
    Negate,
    Binary(Binary),
    Function(Function),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Minimum,
    Maximum,
    Atan2,
}

/// Function of one argument, by its place among [`FUNCTIONS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Function(usize);

/// Name of a function of one argument, and the function.
type NamedFunction = (&'static str, fn(f64) -> f64);

/// Functions of one argument.
const FUNCTIONS: &[NamedFunction] = &[
    ("abs", f64::abs),
    ("signum", f64::signum),
    ("sqrt", f64::sqrt),
    ("cbrt", f64::cbrt),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("log2", f64::log2),
    ("log10", f64::log10),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("sinh", f64::sinh),
    ("cosh", f64::cosh),
    ("tanh", f64::tanh),
    ("asinh", f64::asinh),
    ("acosh", f64::acosh),
    ("atanh", f64::atanh),
    ("floor", f64::floor),
    ("ceil", f64::ceil),
    ("round", f64::round),
    ("trunc", f64::trunc),
    ("fract", f64::fract),
];

/// Functions of two arguments; `min` and `max` take more, too.
const BINARY_FUNCTIONS: &[(&str, Binary)] =
    &[("min", Binary::Minimum), ("max", Binary::Maximum), ("atan2", Binary::Atan2)];

/// Constants.
const CONSTANTS: &[(&str, f64)] =
    &[("pi", PI), ("PI", PI), ("π", PI), ("e", E), ("E", E), ("TAU", TAU), ("τ", TAU)];

/// Return the names of all functions and constants, which name no variable.
pub fn reserved() -> impl Iterator<Item = &'static str> {
    let functions = FUNCTIONS.iter().map(|f| f.0).chain(BINARY_FUNCTIONS.iter().map(|f| f.0));
    functions.chain(CONSTANTS.iter().map(|c| c.0))
}

impl Expression {
    /// Parse a text. Nesting must be bounded by the caller: each level takes stack of the thread.
    ///
    /// # Errors
    /// Invalid expression: the text at which it fails, and the expected continuation.
    pub fn parse(text: &str) -> Result<Self, String> {
        let made = Expression { operations: Vec::new(), names: Vec::new() };
        let mut parser = Parser { rest: text, made };
        parser.sum()?;
        if let Some(next) = parser.peek() {
            let here = parser.rest.trim();
            return Err(match next {
                ')' => format!("`)` without `(` at `{here}`"),
                ',' => format!("`,` outside of a function at `{here}`; decimals are written with a point"),
                _ => format!("an operator (+, -, *, /, ^) is missing before `{here}`"),
            });
        }
        let made = parser.made;
        if made.depth() > STACK {
            return Err(format!("has more than {STACK} operands that wait for their operator"));
        }
        Ok(made)
    }

    /// Return the names of the variables, in the order of their first appearance.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Evaluate with the values of the variables, in the order of [`Expression::names`]. NaN where it is undefined.
    #[must_use]
    pub fn value(&self, variables: &[f64]) -> f64 {
        let mut stack = [0.0; STACK];
        let mut top = 0;
        for operation in &self.operations {
            match *operation {
                Operation::Number(number) => {
                    stack[top] = number;
                    top += 1;
                }
                Operation::Variable(place) => {
                    stack[top] = variables.get(place).copied().unwrap_or(f64::NAN);
                    top += 1;
                }
                Operation::Negate => stack[top - 1] = -stack[top - 1],
                Operation::Function(Function(place)) => stack[top - 1] = FUNCTIONS[place].1(stack[top - 1]),
                Operation::Binary(binary) => {
                    top -= 1;
                    stack[top - 1] = binary.of(stack[top - 1], stack[top]);
                }
            }
        }
        stack[0]
    }

    /// Return the largest number of values on the stack during an evaluation.
    fn depth(&self) -> usize {
        let (mut now, mut most) = (0_usize, 0);
        for operation in &self.operations {
            match operation {
                Operation::Number(_) | Operation::Variable(_) => now += 1,
                Operation::Binary(_) => now -= 1,
                Operation::Negate | Operation::Function(_) => {}
            }
            most = most.max(now);
        }
        most
    }
}

impl Binary {
    fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Add => a + b,
            Binary::Subtract => a - b,
            Binary::Multiply => a * b,
            Binary::Divide => a / b,
            Binary::Power => a.powf(b),
            // Undefined if one of the arguments is, unlike `f64::min`.
            Binary::Minimum if a.is_nan() || b.is_nan() => f64::NAN,
            Binary::Maximum if a.is_nan() || b.is_nan() => f64::NAN,
            Binary::Minimum => a.min(b),
            Binary::Maximum => a.max(b),
            Binary::Atan2 => a.atan2(b),
        }
    }
}

/// Recursive-descent parser.
struct Parser<'a> {
    rest: &'a str,
    made: Expression,
}

impl Parser<'_> {
    /// Skip blanks and return the next character.
    fn peek(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    /// Skip the next character if it is `wanted`.
    fn skip(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.rest = &self.rest[wanted.len_utf8()..];
        }
        found
    }

    fn push(&mut self, operation: Operation) {
        self.made.operations.push(operation);
    }

    fn sum(&mut self) -> Result<(), String> {
        self.product()?;
        loop {
            let binary = if self.skip('+') {
                Binary::Add
            } else if self.skip('-') {
                Binary::Subtract
            } else {
                return Ok(());
            };
            self.product()?;
            self.push(Operation::Binary(binary));
        }
    }

    fn product(&mut self) -> Result<(), String> {
        self.signed()?;
        loop {
            let binary = if self.rest.trim_start().starts_with("**") {
                return Err("`**` is no operator; powers are written `x^2`".into());
            } else if self.skip('*') {
                Binary::Multiply
            } else if self.skip('/') {
                Binary::Divide
            } else {
                return Ok(());
            };
            self.signed()?;
            self.push(Operation::Binary(binary));
        }
    }

    fn signed(&mut self) -> Result<(), String> {
        if self.skip('-') {
            self.signed()?;
            self.push(Operation::Negate);
            return Ok(());
        }
        if self.skip('+') {
            return self.signed();
        }
        self.operand()?;
        if self.skip('^') {
            self.signed()?;
            self.push(Operation::Binary(Binary::Power));
        }
        Ok(())
    }

    fn operand(&mut self) -> Result<(), String> {
        match self.peek() {
            None => Err("a number, a variable or `(` is missing at the end".into()),
            Some('(') => {
                self.skip('(');
                self.sum()?;
                self.close()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(_) => Err(format!("a number, a variable or `(` is missing before `{}`", self.rest)),
        }
    }

    fn close(&mut self) -> Result<(), String> {
        if self.skip(')') {
            return Ok(());
        }
        let here = self.rest.trim();
        Err(if here.is_empty() {
            "`)` is missing at the end".into()
        } else {
            format!("`)` is missing before `{here}`")
        })
    }

    fn number(&mut self) -> Result<(), String> {
        let text = self.rest;
        let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
        let mut end = digits(0);
        if text[end..].starts_with('.') {
            end += 1 + digits(end + 1);
        }
        if text[end..].starts_with(['e', 'E']) {
            let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
            let exponent = digits(end + 1 + sign);
            // Without digits the letter starts a name.
            end += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        let number = text[..end].parse::<f64>().map_err(|_| format!("`{}` is not a number", &text[..end]))?;
        self.rest = &text[end..];
        self.push(Operation::Number(number));
        Ok(())
    }

    fn name(&mut self) -> Result<(), String> {
        let end = self.rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        self.rest = rest;
        if let Some(place) = FUNCTIONS.iter().position(|(known, _)| *known == name) {
            let count = self.arguments(name, None)?;
            if count != 1 {
                return Err(format!("`{name}` takes one argument, and has {count}"));
            }
            self.push(Operation::Function(Function(place)));
            return Ok(());
        }
        if let Some(&(_, binary)) = BINARY_FUNCTIONS.iter().find(|(known, _)| *known == name) {
            let count = self.arguments(name, Some(binary))?;
            if count < 2 || count > 2 && binary == Binary::Atan2 {
                return Err(format!("`{name}` takes two arguments, and has {count}"));
            }
            return Ok(());
        }
        if name == "log" {
            return Err("`log` has two meanings; write `ln` or `log10`".into());
        }
        if self.peek() == Some('(') {
            let known: Vec<&str> =
                FUNCTIONS.iter().map(|f| f.0).chain(BINARY_FUNCTIONS.iter().map(|f| f.0)).collect();
            return Err(format!("`{name}` is not a function; functions are {}", known.join(", ")));
        }
        if let Some(&(_, value)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
            self.push(Operation::Number(value));
            return Ok(());
        }
        let known = self.made.names.iter().position(|n| n == name);
        let place = known.unwrap_or_else(|| {
            self.made.names.push(name.into());
            self.made.names.len() - 1
        });
        self.push(Operation::Variable(place));
        Ok(())
    }

    /// Parse the arguments of a function in parentheses, joined by `join` from the second on, and return their number.
    fn arguments(&mut self, name: &str, join: Option<Binary>) -> Result<usize, String> {
        if !self.skip('(') {
            return Err(format!("`{name}` is a function: write `{name}(...)`"));
        }
        let mut count = 0;
        loop {
            self.sum()?;
            count += 1;
            if let (Some(binary), true) = (join, count > 1) {
                self.push(Operation::Binary(binary));
            }
            if !self.skip(',') {
                self.close()?;
                return Ok(count);
            }
        }
    }
}
