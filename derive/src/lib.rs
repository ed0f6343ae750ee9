//! `#[derive(Content)]`: what a value of a struct or an enum feeds into a digest.

use proc_macro::TokenStream;
use proc_macro2::TokenStream as Tokens;
use quote::{format_ident, quote};
use syn::{Data, DeriveInput, Fields, parse_macro_input};

/// Feeds the fields of a struct in their order, or the name of an enum's variant and then its fields. So no field can be
/// forgotten. It works within the crate `kinora` alone.
#[proc_macro_derive(Content)]
pub fn derive_content(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    let body = match &input.data {
        Data::Struct(data) => {
            let (pattern, feeds) = feeds(&data.fields);
            quote! { let Self #pattern = self; #feeds }
        }
        Data::Enum(data) => {
            let arms = data.variants.iter().map(|variant| {
                let (pattern, feeds) = feeds(&variant.fields);
                let (name, text) = (&variant.ident, variant.ident.to_string());
                quote! { Self::#name #pattern => { crate::base::digest::Content::feed(#text, into); #feeds } }
            });
            quote! { match self { #(#arms)* } }
        }
        Data::Union(_) => {
            let message = "a union has no content: which of its fields is valid is unknown";
            return syn::Error::new_spanned(&input, message).into_compile_error().into();
        }
    };
    let name = &input.ident;
    let (generics, arguments, bounds) = input.generics.split_for_impl();
    quote! {
        impl #generics crate::base::digest::Content for #name #arguments #bounds {
            fn feed(&self, into: &mut crate::base::digest::Digester) { #body }
        }
    }
    .into()
}

/// A pattern that binds all fields, and the statements that feed them.
fn feeds(fields: &Fields) -> (Tokens, Tokens) {
    let names: Vec<_> = match fields {
        Fields::Named(fields) => fields.named.iter().filter_map(|field| field.ident.clone()).collect(),
        _ => (0..fields.len()).map(|index| format_ident!("field_{index}")).collect(),
    };
    let feeds = quote! { #(crate::base::digest::Content::feed(#names, into);)* };
    let pattern = match fields {
        Fields::Named(_) => quote! { { #(#names),* } },
        Fields::Unnamed(_) => quote! { ( #(#names),* ) },
        Fields::Unit => quote! {},
    };
    (pattern, feeds)
}
