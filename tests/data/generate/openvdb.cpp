// Writes OpenVDB files into tests/data/formats, and expected_openvdb.json: what OpenVDB itself reads back from them.
//
//     apt-get install g++ libopenvdb-dev libboost-dev libboost-iostreams-dev
//     g++ -O1 tests/data/generate/openvdb.cpp -lopenvdb -ltbb -lImath-3_1 -o /tmp/openvdb && /tmp/openvdb tests/data/formats
//     gzip -n9 tests/data/formats/none_double.vdb

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

using namespace openvdb;

static std::ostringstream expected;
static std::string folder;

static void numbers(std::ostream &out, const double *values, size_t count) {
    out << '[';
    for (size_t i = 0; i < count; i++) out << (i ? "," : "") << values[i];
    out << ']';
}

// One case of a file: the voxels of the active bounding box, x fastest, and where they lie.
template <typename Grid> static void expect(const std::string &select, const Grid &grid) {
    const CoordBBox box = grid.evalActiveVoxelBoundingBox();
    const auto &transform = grid.transform();
    const Vec3d origin = transform.indexToWorld(box.min());
    expected << "{\"size\":[" << box.dim()[0] << ',' << box.dim()[1] << ',' << box.dim()[2] << "],\"steps\":[";
    for (int axis = 0; axis < 3; axis++) {
        Coord next = box.min();
        next[axis]++;
        const Vec3d step = transform.indexToWorld(next) - origin;
        expected << (axis ? "," : "");
        numbers(expected, step.asPointer(), 3);
    }
    expected << "],\"origin\":";
    numbers(expected, origin.asPointer(), 3);
    expected << select << ",\"values\":[";
    const auto accessor = grid.getConstAccessor();
    bool first = true;
    for (int z = box.min()[2]; z <= box.max()[2]; z++)
        for (int y = box.min()[1]; y <= box.max()[1]; y++)
            for (int x = box.min()[0]; x <= box.max()[0]; x++) {
                expected << (first ? "" : ",") << +accessor.getValue(Coord(x, y, z));
                first = false;
            }
    expected << "]}";
}

static void write(const std::string &name, uint32_t compression, const GridCPtrVec &grids) {
    io::File file(folder + "/" + name);
    file.setCompression(compression);
    file.write(grids);
    file.close();
}

// A box with holes, across the borders of leaves and of nodes of 128 voxels.
template <typename Grid> static typename Grid::Ptr phantom(double least, double step) {
    typedef typename Grid::ValueType Value;
    auto grid = Grid::create(Value(-7));
    auto accessor = grid->getAccessor();
    for (int z = 0; z < 5; z++)
        for (int y = 0; y < 6; y++)
            for (int x = 0; x < 7; x++) {
                const double value = least + step * ((13 * (x + 7 * y)) % 251 + 30 * z * z);
                const Coord at(x - 3, y + 125, z - 131);
                if ((x + 2 * y + z) % 5) accessor.setValue(at, Value(value));
            }
    // The corners, so that the box is what it says.
    accessor.setValue(Coord(-3, 125, -131), Value(least));
    accessor.setValue(Coord(3, 130, -127), Value(least + step));
    return grid;
}

template <typename Grid> static void one(const std::string &name, uint32_t compression, const Grid &grid) {
    write(name, compression, {grid});
    expected << "\n\"" << name << (compression ? "" : ".gz") << "\":[";
    expect("", *grid);
    expected << "],";
}

int main(int, char **arguments) {
    initialize();
    folder = arguments[1];
    expected.precision(17);
    const uint32_t mask = io::COMPRESS_ACTIVE_MASK;
    const uint32_t blosc = io::COMPRESS_BLOSC | mask, zip = io::COMPRESS_ZIP | mask;

    auto plain = phantom<FloatGrid>(-2.5, 0.25);
    plain->setTransform(math::Transform::createLinearTransform(0.5));
    one("blosc_float.vdb", blosc, plain);

    auto half = phantom<FloatGrid>(-2.5, 0.25);
    half->setSaveFloatAsHalf(true);
    auto translated = math::Transform::createLinearTransform(0.25);
    translated->postTranslate(Vec3d(1.5, -2, 30));
    half->setTransform(translated);
    one("zip_half.vdb", zip, half);

    double rows[] = {0, 0.5, 0, 0, -0.75, 0, 0.25, 0, 0, 0, 2, 0, 7, 8, 9, 1};
    auto wide = phantom<DoubleGrid>(-100, 0.5);
    wide->setTransform(math::Transform::createLinearTransform(Mat4d(rows)));
    one("none_double.vdb", io::COMPRESS_NONE, wide);

    auto whole = phantom<Int32Grid>(-300, 1);
    auto stretched = math::Transform::createLinearTransform(1);
    stretched->preScale(Vec3d(1, 2, 3));
    whole->setTransform(stretched);
    one("mask_int32.vdb", mask, whole);
    one("blosc_only_int64.vdb", io::COMPRESS_BLOSC, phantom<Int64Grid>(70000, 3));

    // A tile of 8 voxels, active, beside an inactive one, and voxels around them.
    auto tiles = FloatGrid::create(0.5f);
    tiles->fill(CoordBBox(Coord(8, 0, 0), Coord(15, 7, 7)), 3.0f, true);
    tiles->fill(CoordBBox(Coord(0, 0, 0), Coord(7, 7, 7)), -1.0f, false);
    tiles->getAccessor().setValue(Coord(6, 8, 7), 2.0f);
    tiles->pruneGrid();
    one("tiles.vdb", blosc, tiles);

    auto density = phantom<FloatGrid>(0, 0.125);
    density->setName("density");
    auto velocity = Vec3SGrid::create();
    velocity->setName("velocity");
    velocity->tree().setValue(Coord(0, 0, 0), Vec3s(1, 2, 3));
    auto heat = phantom<FloatGrid>(100, 0.5);
    heat->setName("heat");
    heat->setTransform(math::Transform::createLinearTransform(2));
    write("grids.vdb", blosc, {velocity, density, heat});
    expected << "\n\"grids.vdb\":[";
    expect("", *density);
    expected << ',';
    expect(",\"channel\":2", *heat);
    expected << ',';
    expect(",\"series\":\"heat\"", *heat);
    expected << "]";

    // A sphere of radius 2.5 around (1, 2, 3), with a narrow band of 3 voxels of 0.25; its middle is a hollow of tiles.
    auto sphere = tools::createLevelSetSphere<FloatGrid>(2.5f, Vec3f(1, 2, 3), 0.25f, 3.0f);
    sphere->setName("sphere");
    write("sphere.vdb", zip, {sphere});

    std::ofstream(folder + "/expected_openvdb.json") << '{' << expected.str() << "\n}\n";
}
