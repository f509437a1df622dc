/* The lesser and the greater of two numbers of T. */

static T OF(min)(T a, T b)
{
    if (b < a) {
        return b;
    }
    return a;
}

static T OF(max)(T a, T b)
{
    if (a < b) {
        return b;
    }
    return a;
}
