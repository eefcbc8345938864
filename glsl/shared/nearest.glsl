// nearest: how the search writes out what it does to each of its nearest so far.
//
// An array that is indexed by a loop lives in memory, one element a lane; one that is indexed by
// constants, in registers.
#ifndef NEAREST_GLSL
#define NEAREST_GLSL

#define FOUR(X, a) X(a) X((a) + 1u) X((a) + 2u) X((a) + 3u)
#define FOUR_BACKWARDS(X, a) X((a) + 3u) X((a) + 2u) X((a) + 1u) X(a)
#define SIXTEEN(X, a) FOUR(X, a) FOUR(X, (a) + 4u) FOUR(X, (a) + 8u) FOUR(X, (a) + 12u)
#define SIXTEEN_BACKWARDS(X, a) \
    FOUR_BACKWARDS(X, (a) + 12u) FOUR_BACKWARDS(X, (a) + 8u) FOUR_BACKWARDS(X, (a) + 4u) FOUR_BACKWARDS(X, a)
#define FIFTEEN_BACKWARDS(X) \
    FOUR_BACKWARDS(X, 12u) FOUR_BACKWARDS(X, 8u) FOUR_BACKWARDS(X, 4u) X(3u) X(2u) X(1u)

#ifdef FEW
#define NEAREST 16u
#define EACH(X) SIXTEEN(X, 0u)
#define EACH_BUT_FIRST_BACKWARDS(X) FIFTEEN_BACKWARDS(X)
#else
#define NEAREST 64u
#define EACH(X) SIXTEEN(X, 0u) SIXTEEN(X, 16u) SIXTEEN(X, 32u) SIXTEEN(X, 48u)
#define EACH_BUT_FIRST_BACKWARDS(X) \
    SIXTEEN_BACKWARDS(X, 48u) SIXTEEN_BACKWARDS(X, 32u) SIXTEEN_BACKWARDS(X, 16u) FIFTEEN_BACKWARDS(X)
#endif
#endif
