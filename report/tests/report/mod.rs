//! A whole report of made-up results: its page in a browser, its files in the readers of others.

mod browser;
mod demo;
mod page;
mod readers;
mod tools;
