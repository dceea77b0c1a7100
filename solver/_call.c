/* Calls machine code of kernels: plain C functions int32_t f(const int64_t *slots, int64_t *result), made by compile.py.

   Calls holds the machine code of one kernel, for several lists of argument types ("int float f8.2Cw", see calls.py).
   A call goes to the first that takes its arguments, with the GIL released; where there is none, to self.missed(*args).
   Arrays are read through numpy's C API, numbers through Python's. */

#define PY_SSIZE_T_CLEAN
#define NPY_NO_DEPRECATED_API NPY_1_22_API_VERSION
#include <Python.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#ifdef _MSC_VER
#include <windows.h>
#endif
#include <numpy/arrayobject.h>
#include <numpy/arrayscalars.h>

#define ARGUMENTS 64 /* of a kernel, at most */
#define SLOTS 512    /* numbers, addresses, extents and strides of all of them */

typedef int32_t (*function)(const int64_t *slots, int64_t *result);
enum { NOTHING, FLOAT, INT, BOOL }; /* kinds of what a kernel returns, and of numbers it takes; then an array */

typedef struct {
    char kind;      /* of an array's numbers, as numpy has it ('f', 'i', 'b'); 0: not an array */
    char number;    /* FLOAT, INT or BOOL, where not an array */
    int size, ndim; /* bytes of an item, number of dimensions */
    int flags;      /* of numpy's, that the array must have */
} Type;

typedef struct Code {
    struct Code *next;
    function call;
    Py_ssize_t n;
    Type types[ARGUMENTS];
} Code;

typedef struct {
    PyObject_HEAD
    vectorcallfunc call;
    Code *first;
} Calls;

/* Fill the slots of a number: 1, 0 where it is of another type, -1 with an exception. */
static int
number(const Type *t, PyObject *o, int64_t *slot)
{
    if (t->number == FLOAT) {
        if (!PyFloat_CheckExact(o) && Py_TYPE(o) != &PyDoubleArrType_Type)
            return 0;
        double value = PyFloat_AS_DOUBLE(o);
        memcpy(slot, &value, sizeof value);
    }
    else if (t->number == INT) {
        if (Py_TYPE(o) == &PyInt64ArrType_Type)
            *slot = PyArrayScalar_VAL(o, Int64);
        else if (PyLong_CheckExact(o)) {
            *slot = PyLong_AsLongLong(o);
            if (*slot == -1 && PyErr_Occurred())
                return -1;
        }
        else
            return 0;
    }
    else {
        if (!PyBool_Check(o) && Py_TYPE(o) != &PyBoolArrType_Type)
            return 0;
        *slot = o == Py_True || o == PyArrayScalar_True;
    }
    return 1;
}

/* Fill the slots of all arguments; as above. */
static int
fill(const Code *code, PyObject *const *args, int64_t *slot)
{
    for (Py_ssize_t k = 0; k < code->n; k++) {
        const Type *t = &code->types[k];
        if (!t->kind) {
            int taken = number(t, args[k], slot++);
            if (taken != 1)
                return taken;
            continue;
        }
        if (!PyArray_CheckExact(args[k]))
            return 0;
        PyArrayObject *a = (PyArrayObject *)args[k];
        if (PyArray_NDIM(a) != t->ndim || (PyArray_FLAGS(a) & t->flags) != t->flags ||
            PyArray_DESCR(a)->kind != t->kind || PyArray_ITEMSIZE(a) != t->size || !PyArray_ISNOTSWAPPED(a))
            return 0;
        *slot++ = (int64_t)(intptr_t)PyArray_DATA(a);
        for (int i = 0; i < t->ndim; i++) {
            slot[i] = PyArray_DIM(a, i);
            slot[t->ndim + i] = PyArray_STRIDE(a, i);
        }
        slot += 2 * t->ndim;
    }
    return 1;
}

static PyObject *
run(const Code *code, const int64_t *slots)
{
    int64_t result = 0;
    int32_t kind;
    double value;
    Py_BEGIN_ALLOW_THREADS
    kind = code->call(slots, &result);
    Py_END_ALLOW_THREADS
    switch (kind) {
    case NOTHING:
        Py_RETURN_NONE;
    case FLOAT:
        memcpy(&value, &result, sizeof value);
        return PyFloat_FromDouble(value);
    case INT:
        return PyLong_FromLongLong(result);
    case BOOL:
        return PyBool_FromLong((long)result);
    default: /* kernels raise nothing themselves */
        return PyErr_NoMemory();
    }
}

static PyObject *
call(PyObject *self, PyObject *const *args, size_t nf, PyObject *names)
{
    Py_ssize_t n = PyVectorcall_NARGS(nf);
    int64_t slots[SLOTS];
    PyObject *all[ARGUMENTS + 1];
    if (names != NULL && PyTuple_GET_SIZE(names))
        return PyErr_Format(PyExc_TypeError, "kernels take no keywords");
    for (const Code *code = ((Calls *)self)->first; code != NULL; code = code->next)
        if (code->n == n) {
            int taken = fill(code, args, slots);
            if (taken)
                return taken < 0 ? NULL : run(code, slots);
        }
    if (n > ARGUMENTS)
        return PyErr_Format(PyExc_TypeError, "kernels take at most %d arguments", ARGUMENTS);
    all[0] = self;
    if (n)
        memcpy(all + 1, args, (size_t)n * sizeof *args);
    PyObject *missed = PyUnicode_InternFromString("missed");
    PyObject *out = missed ? PyObject_VectorcallMethod(missed, all, (size_t)n + 1, NULL) : NULL;
    Py_XDECREF(missed);
    return out;
}

/* One word of a list of types; 0 where it is none. */
static int
parse(const char *word, size_t length, Type *t)
{
    const char *names[] = {"float", "int", "bool"};
    memset(t, 0, sizeof *t);
    for (int i = 0; i < 3; i++)
        if (length == strlen(names[i]) && !strncmp(word, names[i], length)) {
            t->number = (char)(FLOAT + i);
            return 1;
        }
    const char *dot = memchr(word, '.', length);
    if (dot == NULL || word + length - dot != 4)
        return 0;
    t->kind = *word == '?' ? 'b' : *word;
    t->size = *word == '?' ? 1 : word[1] - '0';
    t->ndim = dot[1] - '0';
    t->flags = NPY_ARRAY_ALIGNED | (dot[2] == 'C' ? NPY_ARRAY_C_CONTIGUOUS : dot[2] == 'F' ? NPY_ARRAY_F_CONTIGUOUS : 0) |
               (dot[3] == 'w' ? NPY_ARRAY_WRITEABLE : 0);
    return t->ndim >= 0 && t->ndim <= 9;
}

static PyObject *
add(PyObject *self, PyObject *args)
{
    Py_ssize_t address, slots = 0;
    const char *types;
    if (!PyArg_ParseTuple(args, "ns", &address, &types))
        return NULL;
    Code *code = PyMem_Calloc(1, sizeof *code);
    if (code == NULL)
        return PyErr_NoMemory();
    code->call = (function)(intptr_t)address;
    for (const char *word = types; *word;) {
        size_t length = strcspn(word, " ");
        Type *t = &code->types[code->n];
        if (code->n == ARGUMENTS || !parse(word, length, t) || (slots += 1 + 2 * t->ndim) > SLOTS) {
            PyMem_Free(code);
            return PyErr_Format(PyExc_ValueError, "not types that kernels take: %s", types);
        }
        code->n++;
        word += length + (word[length] == ' ');
    }
    Code **last = &((Calls *)self)->first;
    while (*last != NULL)
        last = &(*last)->next;
    *last = code;
    Py_RETURN_NONE;
}

static PyObject *
new(PyTypeObject *type, PyObject *args, PyObject *names)
{
    Calls *self = (Calls *)type->tp_alloc(type, 0);
    if (self != NULL)
        self->call = call;
    return (PyObject *)self;
}

static void
dealloc(PyObject *self)
{
    for (Code *next, *code = ((Calls *)self)->first; code != NULL; code = next) {
        next = code->next;
        PyMem_Free(code);
    }
    Py_TYPE(self)->tp_free(self);
}

static PyMethodDef calls_methods[] = {
    {"add", add, METH_VARARGS, "add(address, types): machine code for arguments of these types."},
    {NULL, NULL, 0, NULL},
};

static PyTypeObject CallsType = {
    PyVarObject_HEAD_INIT(NULL, 0)
    .tp_name = "febkit.solver._call.Calls",
    .tp_doc = "The machine code of a kernel, for several lists of argument types.",
    .tp_basicsize = sizeof(Calls),
    .tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE | Py_TPFLAGS_HAVE_VECTORCALL,
    .tp_vectorcall_offset = offsetof(Calls, call),
    .tp_call = PyVectorcall_Call,
    .tp_new = new,
    .tp_dealloc = dealloc,
    .tp_methods = calls_methods,
};

/* The x86-64 levels that this processor and its operating system have: 1 to 4; 0 on other processors. */
static PyObject *
level(PyObject *self, PyObject *none)
{
    long found = 0;
#if (defined(__GNUC__) || defined(__clang__)) && defined(__x86_64__)
#define HAS(feature) (__builtin_cpu_supports(feature) != 0)
    __builtin_cpu_init();
    int v2 = HAS("popcnt") && HAS("sse3") && HAS("ssse3") && HAS("sse4.1") && HAS("sse4.2");
    int v3 = v2 && HAS("avx") && HAS("avx2") && HAS("bmi") && HAS("bmi2") && HAS("fma");
    int v4 = v3 && HAS("avx512f") && HAS("avx512bw") && HAS("avx512cd") && HAS("avx512dq") && HAS("avx512vl");
    found = 1 + v2 + v3 + v4;
#elif defined(_M_X64)
    found = IsProcessorFeaturePresent(40 /* AVX2 */) ? 3 : IsProcessorFeaturePresent(38 /* SSE4.2 */) ? 2 : 1;
#endif
    return PyLong_FromLong(found);
}

static PyMethodDef methods[] = {
    {"level", level, METH_NOARGS, "The x86-64 level of this processor, 1 to 4; 0 on others."},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef module = {PyModuleDef_HEAD_INIT, "_call", "Calls machine code of kernels.", -1, methods};

PyMODINIT_FUNC
PyInit__call(void)
{
    import_array();
    PyObject *made = PyModule_Create(&module);
    if (made == NULL || PyModule_AddType(made, &CallsType) < 0)
        return NULL;
    return made;
}
