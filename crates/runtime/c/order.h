/* The lesser and the greater of two numbers of T. */

static T OF(min)(T a, T b)
{
    return (b < a) ? b : a;
}

static T OF(max)(T a, T b)
{
    return (a < b) ? b : a;
}
