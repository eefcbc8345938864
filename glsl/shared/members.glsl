// members: the numbers of the objects that a ray is inside, two of them a word.
//
// twin  crates/reference/src/media.rs
#ifndef MEMBERS_GLSL
#define MEMBERS_GLSL

// The nth member, of its word.
uint member_in(uint word, uint nth) {
    return bitfieldExtract(word, 16 * int(nth & 1u), 16);
}

// The word with an object for the nth member.
uint with_member(uint word, uint nth, uint object) {
    return bitfieldInsert(word, object, 16 * int(nth & 1u), 16);
}
#endif
