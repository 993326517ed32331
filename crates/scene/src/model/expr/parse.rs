//! The grammar of expressions, by recursive descent:
//!
//! ```text
//! or      := and ("||" and)*
//! and     := compare ("&&" compare)*
//! compare := sum (("<" | "<=" | ">" | ">=" | "==" | "!=") sum)?
//! sum     := product (("+" | "-") product)*
//! product := unary (("*" | "/") unary)*
//! unary   := ("-" | "+" | "!") unary | power
//! power   := atom ("^" unary)?
//! atom    := number | name | name "(" or ("," or)* ")" | "(" or ")"
//! ```

use super::tokens::{tokenise, Token};
use super::{Ast, Binary, Unary};

/// Largest nesting depth of an expression: the parser recurses, and a scene must not overflow the stack.
const MAX_DEPTH: usize = 64;

/// Parses `text` as an expression in `variables`; the error is one clause that says what is wrong with it.
pub(crate) fn parse(text: &str, variables: &[&str]) -> Result<Ast, String> {
    let mut parser = Parser {
        variables,
        tokens: tokenise(text)?,
        next: 0,
        depth: 0,
    };
    let root = parser.or()?;
    parser.expect(&Token::End, "an operator or the end")?;
    Ok(root)
}

struct Parser<'a> {
    variables: &'a [&'a str],
    tokens: Vec<(usize, Token)>,
    next: usize,
    depth: usize,
}

impl Parser<'_> {
    fn peek(&self) -> &Token {
        &self.tokens[self.next].1
    }

    fn take(&mut self) -> Token {
        let token = self.peek().clone();
        // The last token is End and stays in place.
        self.next = (self.next + 1).min(self.tokens.len() - 1);
        token
    }

    fn accept(&mut self, symbols: &[&'static str]) -> Option<&'static str> {
        match *self.peek() {
            Token::Symbol(s) if symbols.contains(&s) => {
                self.take();
                Some(s)
            }
            _ => None,
        }
    }

    fn unexpected<T>(&self, wanted: &str) -> Result<T, String> {
        let (place, token) = &self.tokens[self.next];
        Err(format!(
            "{token} at character {place} where {wanted} was expected"
        ))
    }

    fn expect(&mut self, token: &Token, wanted: &str) -> Result<(), String> {
        if self.peek() == token {
            self.take();
            Ok(())
        } else {
            self.unexpected(wanted)
        }
    }

    /// A left-associative chain of the operators in `table`.
    fn chain(
        &mut self,
        table: &[(&'static str, Binary)],
        operand: fn(&mut Self) -> Result<Ast, String>,
    ) -> Result<Ast, String> {
        let symbols: Vec<&'static str> = table.iter().map(|(s, _)| *s).collect();
        let mut left = operand(self)?;
        let mut length = 0;
        while let Some(symbol) = self.accept(&symbols) {
            // A long chain is a deep tree on the left, and evaluation recurses: the length is limited too.
            length += 1;
            if length > 1000 {
                return Err(format!("more than 1000 terms joined by `{symbol}`"));
            }
            let op = table
                .iter()
                .find(|(s, _)| *s == symbol)
                .expect("accept returns a symbol of the table")
                .1;
            left = Ast::Binary(op, Box::new(left), Box::new(operand(self)?));
        }
        Ok(left)
    }

    /// The expression that `operand` parses, one level deeper.
    fn nested(
        &mut self,
        operand: impl FnOnce(&mut Self) -> Result<Ast, String>,
    ) -> Result<Ast, String> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(format!("more than {MAX_DEPTH} levels of nesting"));
        }
        let out = operand(self)?;
        self.depth -= 1;
        Ok(out)
    }

    fn or(&mut self) -> Result<Ast, String> {
        self.nested(|parser| parser.chain(&[("||", Binary::Or)], Self::and))
    }

    fn and(&mut self) -> Result<Ast, String> {
        self.chain(&[("&&", Binary::And)], Self::compare)
    }

    fn compare(&mut self) -> Result<Ast, String> {
        let table = [
            ("<", Binary::Lt),
            ("<=", Binary::Le),
            (">", Binary::Gt),
            (">=", Binary::Ge),
            ("==", Binary::Eq),
            ("!=", Binary::Ne),
        ];
        let left = self.sum()?;
        for (symbol, op) in table {
            if self.accept(&[symbol]).is_some() {
                return Ok(Ast::Binary(op, Box::new(left), Box::new(self.sum()?)));
            }
        }
        Ok(left)
    }

    fn sum(&mut self) -> Result<Ast, String> {
        self.chain(&[("+", Binary::Add), ("-", Binary::Sub)], Self::product)
    }

    fn product(&mut self) -> Result<Ast, String> {
        self.chain(&[("*", Binary::Mul), ("/", Binary::Div)], Self::unary)
    }

    fn unary(&mut self) -> Result<Ast, String> {
        match self.accept(&["-", "+", "!"]) {
            None => self.power(),
            Some(symbol) => {
                let operand = self.nested(Self::unary)?;
                Ok(match symbol {
                    "-" => Ast::Unary(Unary::Neg, Box::new(operand)),
                    "!" => Ast::Unary(Unary::Not, Box::new(operand)),
                    _ => operand,
                })
            }
        }
    }

    fn power(&mut self) -> Result<Ast, String> {
        let base = self.atom()?;
        if self.accept(&["^"]).is_none() {
            return Ok(base);
        }
        let exponent = self.nested(Self::unary)?;
        Ok(Ast::Binary(Binary::Pow, Box::new(base), Box::new(exponent)))
    }

    fn atom(&mut self) -> Result<Ast, String> {
        match self.peek().clone() {
            Token::Number(value) => {
                self.take();
                Ok(Ast::Number(value))
            }
            Token::Symbol("(") => {
                self.take();
                let inner = self.or()?;
                self.expect(&Token::Symbol(")"), "`)`")?;
                Ok(inner)
            }
            Token::Name(name) => {
                let place = self.tokens[self.next].0;
                self.take();
                if *self.peek() == Token::Symbol("(") {
                    return self.call(&name, place);
                }
                if let Some(k) = self.variables.iter().position(|v| *v == name) {
                    return Ok(Ast::Variable(k));
                }
                match name.as_str() {
                    "pi" | "PI" | "π" => Ok(Ast::Number(std::f64::consts::PI)),
                    "e" | "E" => Ok(Ast::Number(std::f64::consts::E)),
                    _ => {
                        // Empty names are placeholders for variables that exist only in space.
                        let known = self.variables.iter().filter(|v| !v.is_empty());
                        let known: Vec<&str> = known.copied().collect();
                        Err(format!(
                            "unknown name `{name}` at character {place} (variables are {})",
                            known.join(", ")
                        ))
                    }
                }
            }
            _ => self.unexpected("a number, a name or `(`"),
        }
    }

    fn call(&mut self, name: &str, place: usize) -> Result<Ast, String> {
        self.take();
        let mut arguments = vec![Box::new(self.or()?)];
        while self.accept(&[","]).is_some() {
            arguments.push(Box::new(self.or()?));
        }
        self.expect(&Token::Symbol(")"), "`,` or `)`")?;
        let wrong_count = |found: Vec<Box<Ast>>, wanted: usize| {
            let found = found.len();
            format!(
                "`{name}` at character {place} has {found} arguments where {wanted} were expected"
            )
        };
        let alias = if name == "log" { "ln" } else { name };
        if alias == "if" {
            let [condition, a, b] = arguments
                .try_into()
                .map_err(|found| wrong_count(found, 3))?;
            return Ok(Ast::If(condition, a, b));
        }
        if let Some(op) = Unary::by_name(alias) {
            let [a] = arguments
                .try_into()
                .map_err(|found| wrong_count(found, 1))?;
            return Ok(Ast::Unary(op, a));
        }
        if let Some(op) = Binary::by_name(alias) {
            let [a, b] = arguments
                .try_into()
                .map_err(|found| wrong_count(found, 2))?;
            return Ok(Ast::Binary(op, a, b));
        }
        Err(format!("unknown function `{name}` at character {place}"))
    }
}
