// packet: what eight invocations that run together ask together, for rays from the eye through 4 x 2 pixels.
//
// twin    none: what it leaves out no ray of the packet meets
// A packet is eight lanes of a subgroup, of which larger ones have several: eight consecutive invocations of a
// workgroup along one axis, as drivers lay them out (by gl_SubgroupSize, which may be more than there are, they
// could not be told).
#ifndef PACKET_GLSL
#define PACKET_GLSL
#include "math.glsl"

#define PACKET 8u

// The four planes through the eye that the rays are between: unit normals, inwards.
struct Packet {
    vec3 left;
    vec3 right;
    vec3 below;
    vec3 above;
};

// Which lanes of this one's packet say so, a bit each.
uint packet_ballot(bool says) {
    uvec4 all = subgroupBallot(says);
    uint lane = gl_SubgroupInvocationID;
    return ((lane < 32u ? all.x : all.y) >> (lane & 24u)) & 255u;
}

uint packet_lane() {
    return gl_SubgroupInvocationID % PACKET;
}

// Whether a ball around that place, seen from the eye, is not outside one of the planes.
bool meets_packet(Packet packet, vec3 from_eye, float radius) {
    return dot3(packet.left, from_eye) >= -radius && dot3(packet.right, from_eye) >= -radius
        && dot3(packet.below, from_eye) >= -radius && dot3(packet.above, from_eye) >= -radius;
}
#endif
